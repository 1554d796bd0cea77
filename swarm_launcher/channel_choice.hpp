// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "swarm_core/mission/channel.hpp"

namespace swarm::launcher {

struct ChannelChoice {
  Channel channel = Channel::kTopics;
  std::string reason;  ///< for people
};

/// The state channel of a run with so many agent processes, and why. `wanted` is obeyed. Beyond 32
/// processes the endpoints of moving robots cost more to discover than all else together
/// (docs/BENCHMARKS.md); a process of many robots listens nearly everywhere and gains nothing by
/// groups.
ChannelChoice choose_channel(std::optional<Channel> wanted, std::uint32_t agents,
                             std::uint32_t robots_per_process);

}  // namespace swarm::launcher
