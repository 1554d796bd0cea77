// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::monitor {

/// Whether one can listen there. libwebsockets, which is to do it then, does not say why it cannot.
Result<void> can_bind(const std::string& address, std::uint16_t port);

}  // namespace swarm::monitor
