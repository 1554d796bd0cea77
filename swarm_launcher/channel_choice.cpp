// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/channel_choice.hpp"

#include <fmt/format.h>

namespace swarm::launcher {
namespace {

constexpr std::uint32_t kTopicsAgentsMax = 32;
constexpr std::uint32_t kGroupsPerProcessMax = 4;

}  // namespace

ChannelChoice choose_channel(const ChannelQuestion& question) {
  const auto& [wanted, agents, robots_per_process, multicast] = question;
  if (wanted) return {*wanted, "as asked"};
  if (!multicast) {
    return {Channel::kTopics, "this machine carries no multicast on its loopback interface"};
  }
  if (agents <= kTopicsAgentsMax) {
    return {Channel::kTopics,
            fmt::format("{} agent processes, at most {}", agents, kTopicsAgentsMax)};
  }
  if (robots_per_process > kGroupsPerProcessMax) {
    return {Channel::kTopics, fmt::format("{} robots a process, more than {}", robots_per_process,
                                          kGroupsPerProcessMax)};
  }
  return {Channel::kGroups,
          fmt::format("{} agent processes, more than {}", agents, kTopicsAgentsMax)};
}

}  // namespace swarm::launcher
