// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/robot/control_registry.hpp"
#include "swarmflow/robot/driver_registry.hpp"

namespace swarm::agent {

/// What a robot program can do: its control methods and drivers by name.
struct RobotRegistry {
  ControlRegistry control;
  DriverRegistry drivers;
};

/// The built-in ones, to which a guest adds its own.
RobotRegistry builtin_robots();

/// The main() of a robot program: reads the command line, joins the run that the launcher made and
/// moves the robots it is told to, until a signal or the end of the launcher. With `--describe` it
/// prints what the registry has, as JSON, and ends. Returns the exit code. Once a process.
int run_robot(int argc, char** argv, const RobotRegistry& registry);

}  // namespace swarm::agent
