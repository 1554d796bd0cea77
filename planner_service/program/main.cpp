// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/planning/run_planner.hpp"

int main(int argc, char** argv) {
  return swarm::planner::run_planner(argc, argv, swarm::planner::builtin_planning());
}
