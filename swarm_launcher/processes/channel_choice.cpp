// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/channel_choice.hpp"

#include <fmt/format.h>

namespace swarm::launcher {
namespace {

// Limits by measurement, see the header.
constexpr std::uint32_t kTopicsAgentsMax = 32;
constexpr std::uint32_t kGroupsPerProcessMax = 4;

}  // namespace

// The user's choice comes first, then what is possible, then what is cheaper.
Result<ChannelChoice> choose_channel(const ChannelQuestion& question) {
  const auto& [wanted, agents, robots_per_process, multicast] = question;
  if (wanted == Channel::kGroups && !multicast) {
    return fail(
        ErrorCode::kEnvironment,
        "--channel groups: the interface (lo, or that of --interface) is not there or carries "
        "no multicast; let firewalls pass 239.255.0.0/16, or use --channel topics");
  }
  if (wanted) return ChannelChoice{*wanted, "as asked"};
  if (!multicast) {
    return ChannelChoice{Channel::kTopics, "the interface carries no multicast"};
  }
  if (agents <= kTopicsAgentsMax) {
    return ChannelChoice{Channel::kTopics,
                         fmt::format("{} agent processes, at most {}", agents, kTopicsAgentsMax)};
  }
  if (robots_per_process > kGroupsPerProcessMax) {
    return ChannelChoice{Channel::kTopics, fmt::format("{} robots a process, more than {}",
                                                       robots_per_process, kGroupsPerProcessMax)};
  }
  return ChannelChoice{Channel::kGroups,
                       fmt::format("{} agent processes, more than {}", agents, kTopicsAgentsMax)};
}

}  // namespace swarm::launcher
