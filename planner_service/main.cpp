// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/builtin_methods.hpp"
#include "planner_service/run_planner.hpp"

int main(int argc, char** argv) {
  swarm::planner::PlanningRegistry registry;
  swarm::planner::register_builtin_methods(registry);
  return swarm::planner::run_planner(argc, argv, registry);
}
