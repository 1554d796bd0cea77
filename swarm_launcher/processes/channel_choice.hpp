// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "swarm_core/mission/channel.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// A channel and why it was chosen.
struct ChannelChoice {
  Channel channel = Channel::kTopics;
  std::string reason;  ///< printed and logged
};

/// What the choice depends on.
struct ChannelQuestion {
  std::optional<Channel> wanted{};  ///< the user's choice; refused if it cannot work
  std::uint32_t agents = 0;         ///< agent processes
  std::uint32_t robots_per_process = 1;
  bool multicast = true;  ///< whether the interface carries multicast
};

/// Chooses the state channel of a run. Beyond 32 processes, discovering the endpoints of moving
/// robots costs more than everything else together (docs/BENCHMARKS.md). A process of many robots
/// receives nearly all cells and gains nothing by groups.
Result<ChannelChoice> choose_channel(const ChannelQuestion& question);

}  // namespace swarm::launcher
