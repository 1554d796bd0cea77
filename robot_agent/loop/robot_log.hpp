// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_core/blackbox/record.hpp"

namespace swarm::agent {

/// Where the control loop of one robot records what it did: a file in a process, memory in a
/// simulation. Takes records in the order of their stamps; called from the robot's thread. A sink
/// that cannot store a record drops it: recording never stops a robot.
class RobotLog {
 public:
  virtual ~RobotLog() = default;
  virtual void append(const blackbox::Step& step) = 0;
  virtual void append(const blackbox::Belief& estimate) = 0;
  virtual void append(blackbox::Note note) = 0;
};

}  // namespace swarm::agent
