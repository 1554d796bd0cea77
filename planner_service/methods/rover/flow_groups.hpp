// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner_service/methods/rover/risk_graph.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/planning/measured_swarm.hpp"

namespace swarm::planner {

/// How groups of robots of one leg are divided and joined.
struct FlowGroupOptions {
  double sigma_max_m = 8.0;    ///< a wider group is divided across its longer axis
  double sigma_floor_m = 0.5;  ///< added to each group's shape: one robot has none
  double join_m = 6.0;         ///< groups nearer than this, in W₂, become one
  double clearance_m = 0.3;    ///< of a group's mean to obstacles; below, it is divided
  std::size_t groups_max = 64;
};

/// The measured state of a swarm that follows a plan: the robots of a leg are a group, with the
/// Gaussian of their own positions, so that the new plan begins where the swarm is and a robot's
/// leg goes on. Groups that came together are joined, wide ones divided. Robots without a leg are
/// grouped by the most likely mixture of the collocation set. Robots that arrived form a group for
/// each component of the goal they were led to, with its Gaussian: a waiting leg. \pre some robots
std::vector<RobotGroup> group_by_flow(std::span<const ReportedRobot> robots, const RiskGraph& graph,
                                      const Mixture& goal, const FlowGroupOptions& options);

/// The goal with its weights as whole numbers of robots, each the next below or above its exact
/// share: robots that have arrived stay, and no fraction of a robot has to move. `led` counts the
/// robots led to each component; of the roundings, the one that changes fewest goals and keeps the
/// limit (11g), else the goal as it is.
Mixture goal_in_robots(const Mixture& goal, std::span<const std::size_t> led, std::size_t robots,
                       const World& world, const RiskLimit& risk);

/// Orders each group's members by rank, so that their stratified shares assign them to near routes:
/// in each group the assignment of robots to the routes that its ranks draw with the least total
/// cost. The cost of a pair is the squared distance to the robot's position at the end of the first
/// leg, and kOtherGoal_m2 more for another goal than before. \pre group i is the plan's source i
void order_by_flow(std::vector<RobotGroup>& groups, const FlowPlan& plan, const Mixture& goal,
                   std::span<const ReportedRobot> robots);
inline constexpr double kOtherGoal_m2 = 25.0;

}  // namespace swarm::planner
