// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "robot_agent/program/process_options.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/robot/run_robot.hpp"

namespace swarm::agent {

/// The names and keys of a mission that a robot program knows; the planner's section is open.
Catalogue catalogue_of(const RobotRegistry& registry);

/// The program: reads the run directory, joins the bus and ticks its robots by the steady clock.
class AgentProcess {
 public:
  /// Fails when the run directory or the mission is bad, a driver does not start, or the bus
  /// cannot be joined.
  static Result<std::unique_ptr<AgentProcess>> make(const ProcessOptions& options,
                                                    const RobotRegistry& registry);
  ~AgentProcess();

  /// Runs until a stop signal or the end of the parent.
  Result<void> run();

 private:
  struct Impl;
  explicit AgentProcess(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace swarm::agent
