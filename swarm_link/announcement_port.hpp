// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::link {

/// Where a participant of this index listens for others' announcements: the port of both vendors'
/// defaults (DDSI-RTPS 9.6.1.1).
inline std::uint16_t announcement_port(std::uint32_t domain, std::uint32_t index) {
  return static_cast<std::uint16_t>(7410 + 250 * domain + 2 * index);
}

}  // namespace swarm::link
