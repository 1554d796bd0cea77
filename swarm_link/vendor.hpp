// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::link {

/// Whose DDS a process speaks; they understand each other.
enum class Vendor : std::uint8_t { kFastDds, kCycloneDds };

/// Either may be left out of a build (SWARM_WITH_FASTDDS, SWARM_WITH_CYCLONEDDS); what would make
/// its participants then fails.
bool built_with(Vendor vendor);

}  // namespace swarm::link
