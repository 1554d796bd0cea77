// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/planning/planning_registry.hpp"

/// Planning: what a planning method is written against, and the program that runs it.
namespace swarm::planner {

/// The built-in methods (swarmprm, rover, crops, adoc), to which a program adds its own.
PlanningRegistry builtin_planning();

/// The whole planner program, to be returned from main():
///
///   int main(int argc, char** argv) {
///     auto registry = swarm::planner::builtin_planning();
///     registry.add(my_method());
///     return swarm::planner::run_planner(argc, argv, registry);
///   }
///
/// Reads the command line, plans the mission of the run directory with the method it names, and
/// publishes plans and heartbeats until a signal or the end of the launcher. With `--describe` it
/// prints the registry as JSON and ends: that is how the launcher checks a mission's keys. Does not
/// throw.
/// \param registry its methods; outlives the call
/// \return the exit code (ExitCode)
/// \pre at most one call per process, from its main thread, since it handles signals
int run_planner(int argc, char** argv, const PlanningRegistry& registry);

}  // namespace swarm::planner
