// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "swarm_core/app/shared_steps.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Finds the robots of this host that make no control steps: their processes are dead or frozen.
/// Looks four times a second. The time is passed in.
class StepWatch {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(250);

  /// A robot that makes steps again is reported after this time. By then its status has arrived,
  /// unless it is cut off, and a restarted one has left the place of its last step.
  static constexpr Duration kBack = std::chrono::seconds(5);

  /// `silent`: the time without a step after which a robot is reported. \pre the steps have places
  /// for these robots, and outlive the object
  StepWatch(const shell::SharedSteps& steps, RobotId first, std::uint32_t robots, Duration silent)
      : steps_(steps), first_(first), silent_(silent), robots_(robots) {}

  struct Change {
    RobotId robot;
    bool is_silent = false;  ///< false: it makes steps again
  };
  /// Robots that have fallen silent, and those of them that make steps again. A robot that has
  /// never made one is not among them.
  std::vector<Change> step(SteadyTime now);

  /// Robots that have made no step for kHung: their processes are dead, or to be killed, as the
  /// launcher kills those of its own host.
  static constexpr Duration kHung = std::chrono::seconds(10);
  std::vector<RobotId> hung(SteadyTime now) const;

 private:
  struct Robot {
    UtcTime last{};
    SteadyTime stepped_at{};
    SteadyTime began_at{};  ///< to make steps, after a silence
    bool is_silent = true;
    bool is_reported = false;  ///< as silent
  };

  const shell::SharedSteps& steps_;
  RobotId first_;
  Duration silent_;
  std::vector<Robot> robots_;
  SteadyTime next_look_{};
  SteadyTime looked_at_{};
};

}  // namespace swarm::launcher
