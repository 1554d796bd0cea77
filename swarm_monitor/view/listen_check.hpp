// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::monitor {

/// Whether a server can listen at this address and port. libwebsockets, which does so afterwards,
/// does not report the reason of a failure.
Result<void> can_bind(const std::string& address, std::uint16_t port);

}  // namespace swarm::monitor
