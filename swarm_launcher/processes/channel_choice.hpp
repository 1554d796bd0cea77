// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "swarmflow/core/result.hpp"
#include "swarm_core/mission/channel.hpp"

namespace swarm::launcher {

struct ChannelChoice {
  Channel channel = Channel::kTopics;
  std::string reason;  ///< for people
};

struct ChannelQuestion {
  std::optional<Channel> wanted{};  ///< obeyed, or refused where it cannot work
  std::uint32_t agents = 0;         ///< processes
  std::uint32_t robots_per_process = 1;
  bool multicast = true;  ///< whether the interface carries it
};

/// The state channel of a run, and why. Beyond 32 processes the endpoints of moving robots cost
/// more to discover than all else together (docs/BENCHMARKS.md); a process of many robots listens
/// nearly everywhere and gains nothing by groups.
Result<ChannelChoice> choose_channel(const ChannelQuestion& question);

}  // namespace swarm::launcher
