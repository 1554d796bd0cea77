// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/run_robot.hpp"

int main(int argc, char** argv) {
  return swarm::agent::run_robot(argc, argv, swarm::agent::builtin_robots());
}
