// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::link {

/// Whose DDS a process speaks; they understand each other.
enum class Vendor : std::uint8_t { kFastDds, kCycloneDds };

}  // namespace swarm::link
