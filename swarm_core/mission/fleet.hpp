// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm {

/// The bodies of all robots, as every robot knows them from the mission file: radius and top speed.
class Fleet {
 public:
  /// Size and largest speed of one robot.
  struct Body {
    double radius_m = 0.2;
    double speed_max_mps = 1.5;
  };

  /// A fleet in which every robot has the default body.
  Fleet() = default;
  /// A fleet in which every robot has the same body.
  explicit Fleet(const Body& all) : rest_(all) {}
  /// The bodies of a mission: groups take the ids from 0 in order, the others follow.
  explicit Fleet(const RobotsSpec& robots) : rest_{robots.radius_m, robots.speed_max_mps} {
    std::uint32_t end = 0;
    for (const RobotGroupSpec& group : robots.groups) {
      end += group.count;
      groups_.push_back({end, {group.radius_m, group.speed_max_mps}});
    }
  }

  /// The body of a robot. O(groups).
  const Body& of(RobotId robot) const {
    for (const Group& group : groups_) {
      if (robot.value() < group.end) return group.body;
    }
    return rest_;
  }

 private:
  /// Robots with consecutive ids and the same body.
  struct Group {
    std::uint32_t end;  // first id behind it
    Body body;
  };
  Body rest_;
  std::vector<Group> groups_;
};

}  // namespace swarm
