// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace swarm {

/// The transport of the robots' state updates: DDS topics per cell, or multicast groups per cell;
/// see docs/design.md.
enum class Channel { kTopics, kGroups };

constexpr std::string_view to_string(Channel channel) {
  return channel == Channel::kTopics ? "topics" : "groups";
}

}  // namespace swarm
