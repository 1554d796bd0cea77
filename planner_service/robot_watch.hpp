// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "swarmflow/planning/measured_swarm.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::planner {

/// What the planner knows of the robots: their last word, while it is fresh, and since when those
/// on their way have not come on.
class RobotWatch {
 public:
  /// Less than this is no progress.
  static constexpr double kProgress_m = 0.5;

  RobotWatch(std::uint32_t robots, Duration forget_after)
      : heard_(robots), forget_after_(forget_after) {}

  /// `moving` = on its way, wants to move. \pre the id is below the number of robots
  void hear(const ReportedRobot& robot, bool moving, SteadyTime now) {
    std::optional<Heard>& heard = heard_.at(robot.robot.value());
    const bool stands = heard && moving && heard->moving &&
                        (robot.position_m - heard->stands_m).norm() < kProgress_m;
    heard = Heard{.robot = robot,
                  .at = now,
                  .moving = moving,
                  .stands_m = stands ? heard->stands_m : robot.position_m,
                  .stands_since = stands ? heard->stands_since : now};
  }

  /// As if nothing was received of it. \pre the id is below the number of robots
  void forget(RobotId robot) { heard_.at(robot.value()).reset(); }

  /// Robots heard lately, by id.
  std::vector<ReportedRobot> fresh(SteadyTime now) const {
    std::vector<ReportedRobot> robots;
    for (const std::optional<Heard>& heard : heard_) {
      if (is_fresh(heard, now)) robots.push_back(heard->robot);
    }
    return robots;
  }

  bool heard_all(SteadyTime now) const { return fresh(now).size() == heard_.size(); }

  /// Those of them that are on their way and have not come on for so long.
  std::vector<ReportedRobot> stuck(SteadyTime now, Duration after) const {
    std::vector<ReportedRobot> robots;
    for (const std::optional<Heard>& heard : heard_) {
      if (is_fresh(heard, now) && heard->moving && heard->at - heard->stands_since >= after) {
        robots.push_back(heard->robot);
      }
    }
    return robots;
  }

  /// They are given time to come on before they count as stuck again.
  void forgive(SteadyTime now) {
    for (std::optional<Heard>& heard : heard_) {
      if (heard) heard->stands_since = now;
    }
  }

 private:
  struct Heard {
    ReportedRobot robot;
    SteadyTime at;
    bool moving = false;
    Vec2 stands_m = Vec2::Zero();
    SteadyTime stands_since;
  };
  bool is_fresh(const std::optional<Heard>& heard, SteadyTime now) const {
    return heard && now - heard->at <= forget_after_;
  }

  std::vector<std::optional<Heard>> heard_;
  Duration forget_after_;
};

}  // namespace swarm::planner
