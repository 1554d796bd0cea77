// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/builtin_catalogue.hpp"

#include "robot_drivers/ros/ros_options.hpp"
#include "swarmflow/planning/run_planner.hpp"
#include "swarmflow/robot/control_registry.hpp"
#include "swarmflow/robot/driver_registry.hpp"

namespace swarm {

const Catalogue& builtin_catalogue() {
  // Created once; initialisation of a static is thread-safe in C++.
  static const Catalogue catalogue = [] {
    agent::DriverRegistry bodies;
    agent::register_builtin_drivers(bodies);
    Catalogue made;
    made.planning_methods = planner::builtin_planning().specs();
    made.control_methods = agent::builtin_control().specs();
    made.drivers = bodies.specs();
    made.drivers.push_back(drivers::ros_driver_spec());
    return made;
  }();
  return catalogue;
}

}  // namespace swarm
