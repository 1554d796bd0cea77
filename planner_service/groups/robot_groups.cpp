// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/groups/robot_groups.hpp"

#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "planner_service/groups/group_shape.hpp"
#include "planner_service/roadmap/squeeze.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// Factor of the radius while there are too many groups.
constexpr double kWider = 1.5;

/// The goal component that a robot has arrived in, if any.
std::optional<std::size_t> goal_of(const ReportedRobot& robot, const Mixture& goal) {
  std::optional<std::size_t> reached;
  double nearest = kChiSquared2Dof99;
  if (!robot.arrived) return reached;
  for (std::size_t j = 0; j < goal.components().size(); ++j) {
    const double d = goal.components()[j].gaussian.mahalanobis_squared(robot.position_m);
    if (d > nearest) continue;
    nearest = d;
    reached = j;
  }
  return reached;
}

/// Leader clustering: a robot joins the nearest group whose first robot is within the radius and in
/// line of sight, or begins a group. O(robots · groups).
std::vector<Members> cluster(const Members& robots, const World& world, double radius_m) {
  std::vector<Members> clusters;
  for (const ReportedRobot* robot : robots) {
    Members* nearest = nullptr;
    double nearest_m = radius_m;
    for (Members& members : clusters) {
      const Vec2& leader_m = members.front()->position_m;
      const double distance_m = (robot->position_m - leader_m).norm();
      if (distance_m > nearest_m || !world.segment_is_free(leader_m, robot->position_m, 0.0)) {
        continue;
      }
      nearest_m = distance_m;
      nearest = &members;
    }
    if (nearest != nullptr) {
      nearest->push_back(robot);
    } else {
      clusters.push_back({robot});
    }
  }
  return clusters;
}

/// The members' Gaussian where it keeps the limit; else one around the first of them.
std::optional<Gaussian> free_shape_of(const Members& members, const World& world,
                                      const RiskLimit& risk, const GroupOptions& options) {
  const double k = cvar_coefficient(risk.alpha);
  // Slightly more than the narrowest σ needs, so that the squeeze does not end below it.
  const double room_m = k * options.sigma_least_m * (1.0 + 1e-6) - risk.delta_m;
  for (const Members& of : {members, Members{members.front()}}) {
    const Gaussian pushed = push_out(shape_of(of, options.sigma_floor_m), world, room_m);
    if (auto fits = squeeze_into_free(pushed, world, k, risk.delta_m, options.sigma_least_m)) {
      return fits;
    }
  }
  return std::nullopt;
}

/// Robots along the longer axis of their group.
RobotGroup group_of(Members members, const Gaussian& gaussian) {
  sort_along_axis(members, gaussian);
  return {gaussian, ids_of(members)};
}

}  // namespace

// Arrived robots first, by goal component, then clusters of the others. The sort along the axis
// gives neighbouring robots neighbouring ranks, hence neighbouring shares of the plan.
Result<std::vector<RobotGroup>> group_robots(const MeasuredSwarm& swarm, const RiskLimit& risk,
                                             const GroupOptions& options) {
  SWARM_ASSERT(!swarm.robots.empty());
  const World& world = swarm.world;
  const Mixture& goal = swarm.goal;
  std::vector<Members> arrived(goal.components().size());
  Members under_way;
  for (const ReportedRobot& robot : swarm.robots) {
    const auto reached = goal_of(robot, goal);
    (reached ? arrived[*reached] : under_way).push_back(&robot);
  }
  double radius_m = options.radius_m;
  std::vector<Members> clusters = cluster(under_way, world, radius_m);
  // Walls separate groups at any radius, so that the number of tries is bounded.
  for (int tries = 0; clusters.size() > options.groups_max && tries < 16; ++tries) {
    radius_m *= kWider;
    clusters = cluster(under_way, world, radius_m);
  }
  std::vector<RobotGroup> groups;
  for (std::size_t j = 0; j < arrived.size(); ++j) {
    if (arrived[j].empty()) continue;
    groups.push_back(group_of(arrived[j], goal.components()[j].gaussian));
  }
  for (const Members& members : clusters) {
    const auto gaussian = free_shape_of(members, world, risk, options);
    if (!gaussian) {
      const Vec2& at_m = members.front()->position_m;
      return fail(ErrorCode::kInfeasible,
                  fmt::format("{} robots near ({:.1f}, {:.1f}) m are too near an obstacle for any "
                              "Gaussian that keeps planner.risk_delta_m ({} m)",
                              members.size(), at_m.x(), at_m.y(), risk.delta_m));
    }
    groups.push_back(group_of(members, *gaussian));
  }
  return groups;
}

std::optional<std::uint32_t> component_at(const Mixture& goal, const Vec2& mean_m) {
  constexpr double kSame_m = 1e-6;
  for (std::uint32_t j = 0; j < goal.components().size(); ++j) {
    if ((goal.components()[j].gaussian.mean_m() - mean_m).norm() < kSame_m) return j;
  }
  return std::nullopt;
}

}  // namespace swarm::planner
