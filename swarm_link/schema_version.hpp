// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::link {

/// Version of idl/swarm.idl, in every message that has a topic. A receiver refuses any other.
inline constexpr std::uint16_t kSchemaVersion = 5;

}  // namespace swarm::link
