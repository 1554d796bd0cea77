// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::launcher {

/// DDS implementation of the agents.
enum class AgentDds : std::uint8_t { kFastDds, kCycloneDds, kHalf /* every other one Cyclone's */ };

}  // namespace swarm::launcher
