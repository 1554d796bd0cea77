// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/planning/planning_registry.hpp"

namespace swarm::planner {

/// The built-in methods, to which a guest adds its own.
PlanningRegistry builtin_planning();

/// The whole planner program, for the main() of ours and of a guest: reads the command line, plans
/// the mission of the run directory with the method it names, publishes plan and heartbeat until it
/// is stopped. With `--describe` it prints what the registry has, as JSON, and ends. Returns the
/// exit code. The registry must outlive the call. One per process, since it handles signals.
int run_planner(int argc, char** argv, const PlanningRegistry& registry);

}  // namespace swarm::planner
