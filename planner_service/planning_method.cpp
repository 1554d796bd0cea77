// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/planning/planning_method.hpp"

#include "planner_service/groups/robot_groups.hpp"

namespace swarm::planner {

Result<std::vector<RobotGroup>> PlanningMethod::measure(const MeasuredSwarm& swarm) {
  return group_robots(swarm, risk(), {});
}

}  // namespace swarm::planner
