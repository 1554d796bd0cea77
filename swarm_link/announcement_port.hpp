// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::link {

/// Port at which a participant of this index receives discovery announcements: the default of both
/// vendors (DDSI-RTPS 9.6.1.1).
inline std::uint16_t announcement_port(std::uint32_t domain, std::uint32_t index) {
  return static_cast<std::uint16_t>(7410 + 250 * domain + 2 * index);
}

}  // namespace swarm::link
