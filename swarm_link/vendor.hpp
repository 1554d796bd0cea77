// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::link {

/// DDS implementation of a process; the two interoperate.
enum class Vendor : std::uint8_t { kFastDds, kCycloneDds };

/// Whether an implementation is part of this build (SWARM_WITH_FASTDDS, SWARM_WITH_CYCLONEDDS).
/// Without it, creating its participants fails.
bool built_with(Vendor vendor);

}  // namespace swarm::link
