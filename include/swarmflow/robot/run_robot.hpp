// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/robot/control_registry.hpp"
#include "swarmflow/robot/driver_registry.hpp"

/// Robots: what a driver or a control method is written against, and the program that runs them.
namespace swarm::agent {

/// What a robot program can do: its control methods and drivers by name.
struct RobotRegistry {
  ControlRegistry control;  ///< the values of `control.method` that it has
  DriverRegistry drivers;   ///< the values of `robots.model` that it has
};

/// The built-in control methods and drivers, to which a program adds its own.
RobotRegistry builtin_robots();

/// The whole robot program, to be returned from main():
///
///   int main(int argc, char** argv) {
///     auto registry = swarm::agent::builtin_robots();
///     registry.drivers.add(my_driver());
///     return swarm::agent::run_robot(argc, argv, registry);
///   }
///
/// Reads the command line, joins the run whose directory the launcher made, and moves the robots
/// that the launcher names, until a signal or the end of the launcher. With `--describe` it prints
/// the registry as JSON and ends: that is how the launcher checks a mission's keys. Does not throw.
/// \param registry its components; outlives the call
/// \return the exit code (ExitCode)
/// \pre at most one call per process, from its main thread, since it handles signals
int run_robot(int argc, char** argv, const RobotRegistry& registry);

}  // namespace swarm::agent
