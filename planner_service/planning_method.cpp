// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/planning/planning_method.hpp"

#include "planner_service/groups/robot_groups.hpp"

namespace swarm::planner {

Result<std::vector<RobotGroup>> PlanningMethod::measure(const MeasuredSwarm& swarm) {
  const GroupOptions usual;
  return group_robots(swarm, risk(),
                      {.radius_m = swarm.length_scale * usual.radius_m,
                       .sigma_floor_m = swarm.length_scale * usual.sigma_floor_m,
                       .sigma_least_m = swarm.length_scale * usual.sigma_least_m});
}

}  // namespace swarm::planner
