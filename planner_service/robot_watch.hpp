// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "planner_service/robot_groups.hpp"
#include "swarm_core/base/time.hpp"

namespace swarm::planner {

/// What the planner knows of the robots: their last word, while it is fresh.
class RobotWatch {
 public:
  RobotWatch(std::uint32_t robots, Duration forget_after)
      : heard_(robots), forget_after_(forget_after) {}

  /// \pre the id is below the number of robots
  void hear(const HeardRobot& robot, SteadyTime now) {
    heard_.at(robot.robot.value()) = Heard{robot, now};
  }

  /// Robots heard lately, by id.
  std::vector<HeardRobot> fresh(SteadyTime now) const {
    std::vector<HeardRobot> robots;
    for (const std::optional<Heard>& heard : heard_) {
      if (heard && now - heard->at <= forget_after_) robots.push_back(heard->robot);
    }
    return robots;
  }

  bool heard_all(SteadyTime now) const { return fresh(now).size() == heard_.size(); }

 private:
  struct Heard {
    HeardRobot robot;
    SteadyTime at;
  };
  std::vector<std::optional<Heard>> heard_;
  Duration forget_after_;
};

}  // namespace swarm::planner
