// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "swarmflow/core/time.hpp"
#include "swarmflow/planning/measured_swarm.hpp"

namespace swarm::planner {

/// The planner's estimate of the robots: the last status of each while it is fresh, and since when
/// robots under way have made no progress.
class RobotWatch {
 public:
  /// Less than this is no progress, of default bodies (body_scale.hpp).
  static constexpr double kProgress_m = 0.5;

  RobotWatch(std::uint32_t robots, Duration forget_after, double scale = 1.0)
      : received_(robots), forget_after_(forget_after), progress_m_(scale * kProgress_m) {}

  /// `moving`: the robot is under way. \pre the id is below the number of robots
  void receive(const ReportedRobot& robot, bool moving, SteadyTime now) {
    std::optional<Received>& received = received_.at(robot.robot.value());
    const bool is_stopped = received && moving && received->moving &&
                            (robot.position_m - received->stopped_at_m).norm() < progress_m_;
    received = Received{.robot = robot,
                        .at = now,
                        .moving = moving,
                        .stopped_at_m = is_stopped ? received->stopped_at_m : robot.position_m,
                        .stopped_since = is_stopped ? received->stopped_since : now};
  }

  /// Drops the last status of a robot. \pre the id is below the number of robots
  void forget(RobotId robot) { received_.at(robot.value()).reset(); }

  /// Last status of each robot that reported lately, by id.
  std::vector<ReportedRobot> fresh(SteadyTime now) const {
    std::vector<ReportedRobot> robots;
    for (const std::optional<Received>& received : received_) {
      if (is_fresh(received, now)) robots.push_back(received->robot);
    }
    return robots;
  }

  /// Whether it reported lately. \pre the id is below the number of robots
  bool is_received(RobotId robot, SteadyTime now) const {
    return is_fresh(received_.at(robot.value()), now);
  }
  bool received_all(SteadyTime now) const { return fresh(now).size() == received_.size(); }

  /// Fresh robots under way that have made no progress for at least `after`.
  std::vector<ReportedRobot> stuck(SteadyTime now, Duration after) const {
    std::vector<ReportedRobot> robots;
    for (const std::optional<Received>& received : received_) {
      if (is_fresh(received, now) && received->moving &&
          received->at - received->stopped_since >= after) {
        robots.push_back(received->robot);
      }
    }
    return robots;
  }

  /// Restarts the timers of all robots: each has the full time before it counts as stuck again.
  void reset_stuck_timers(SteadyTime now) {
    for (std::optional<Received>& received : received_) {
      if (received) received->stopped_since = now;
    }
  }

 private:
  // The last status of a robot and the position from which it makes progress.
  struct Received {
    ReportedRobot robot;
    SteadyTime at;
    bool moving = false;
    Vec2 stopped_at_m = Vec2::Zero();
    SteadyTime stopped_since;
  };
  bool is_fresh(const std::optional<Received>& received, SteadyTime now) const {
    return received && now - received->at <= forget_after_;
  }

  std::vector<std::optional<Received>> received_;
  Duration forget_after_;
  double progress_m_;
};

}  // namespace swarm::planner
