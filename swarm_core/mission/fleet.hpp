// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm {

/// What every robot knows of every other from the mission: how large and how fast it may be.
class Fleet {
 public:
  struct Body {
    double radius_m = 0.2;
    double speed_max_mps = 1.5;
  };

  Fleet() = default;
  explicit Fleet(const Body& all) : rest_(all) {}
  explicit Fleet(const RobotsSpec& robots) : rest_{robots.radius_m, robots.speed_max_mps} {
    std::uint32_t end = 0;
    for (const RobotGroupSpec& group : robots.groups) {
      end += group.count;
      groups_.push_back({end, {group.radius_m, group.speed_max_mps}});
    }
  }

  const Body& of(RobotId robot) const {
    for (const Group& group : groups_) {
      if (robot.value() < group.end) return group.body;
    }
    return rest_;
  }

 private:
  struct Group {
    std::uint32_t end;  // first id behind it
    Body body;
  };
  Body rest_;
  std::vector<Group> groups_;
};

}  // namespace swarm
