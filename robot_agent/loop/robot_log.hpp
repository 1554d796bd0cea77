// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_core/robot_log/record.hpp"

namespace swarm::agent {

/// Where the control loop of one robot records what it did: a file in a process, memory in a
/// simulation. Takes records in the order of their stamps; called from the robot's thread. A sink
/// that cannot store a record drops it: recording never stops a robot.
class RobotLog {
 public:
  virtual ~RobotLog() = default;
  virtual void append(const robot_log::Step& step) = 0;
  virtual void append(const robot_log::Estimate& estimate) = 0;
  virtual void append(robot_log::Note note) = 0;
};

}  // namespace swarm::agent
