// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/robot_groups.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "planner_service/roadmap/squeeze.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

constexpr double kWider = 1.5;

using Members = std::vector<const HeardRobot*>;

/// The goal component a robot is at home in, if it arrived.
std::optional<std::size_t> home_of(const HeardRobot& robot, const Mixture& goal) {
  std::optional<std::size_t> home;
  double nearest = kChiSquared2Dof99;
  if (!robot.arrived) return home;
  for (std::size_t j = 0; j < goal.components().size(); ++j) {
    const double d = goal.components()[j].gaussian.mahalanobis_squared(robot.position_m);
    if (d > nearest) continue;
    nearest = d;
    home = j;
  }
  return home;
}

/// Leader clustering: a robot joins the nearest group whose first robot it sees within the radius,
/// or begins one.
std::vector<Members> cluster(const Members& robots, const World& world, double radius_m) {
  std::vector<Members> clusters;
  for (const HeardRobot* robot : robots) {
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

Gaussian shape_of(const Members& members, double sigma_floor_m) {
  Vec2 mean_m = Vec2::Zero();
  for (const HeardRobot* robot : members) mean_m += robot->position_m;
  mean_m /= static_cast<double>(members.size());
  Mat2 covariance_m2 = Mat2::Zero();
  for (const HeardRobot* robot : members) {
    const Vec2 offset_m = robot->position_m - mean_m;
    covariance_m2 += offset_m * offset_m.transpose();
  }
  covariance_m2 /= static_cast<double>(members.size());
  return Gaussian::from_valid(mean_m,
                              covariance_m2 + sigma_floor_m * sigma_floor_m * Mat2::Identity());
}

/// The members' Gaussian where it keeps the limit; else one around the first of them.
std::optional<Gaussian> free_shape_of(const Members& members, const World& world,
                                      const RiskLimit& risk, const GroupOptions& options) {
  const double k = cvar_coefficient(risk.alpha);
  // A hair more than the narrowest needs, so that the squeeze that follows does not end below it.
  const double room_m = k * options.sigma_least_m * (1.0 + 1e-6) - risk.delta_m;
  for (const Members& of : {members, Members{members.front()}}) {
    const Gaussian pushed = push_out(shape_of(of, options.sigma_floor_m), world, room_m);
    if (auto fits = squeeze_into_free(pushed, world, k, risk.delta_m, options.sigma_least_m)) {
      return fits;
    }
  }
  return std::nullopt;
}

std::vector<RobotId> ordered_ids(Members members, const Gaussian& gaussian) {
  const Mat2& c = gaussian.covariance_m2();
  const double angle_rad = 0.5 * std::atan2(2.0 * c(0, 1), c(0, 0) - c(1, 1));
  const Vec2 axis(std::cos(angle_rad), std::sin(angle_rad));
  std::stable_sort(members.begin(), members.end(), [&](const HeardRobot* a, const HeardRobot* b) {
    return axis.dot(a->position_m) < axis.dot(b->position_m);
  });
  std::vector<RobotId> ids;
  for (const HeardRobot* robot : members) ids.push_back(robot->robot);
  return ids;
}

}  // namespace

Result<std::vector<RobotGroup>> group_robots(std::span<const HeardRobot> robots, const World& world,
                                             const Mixture& goal, const RiskLimit& risk,
                                             const GroupOptions& options) {
  SWARM_ASSERT(!robots.empty());
  std::vector<Members> at_home(goal.components().size());
  Members on_the_way;
  for (const HeardRobot& robot : robots) {
    const auto home = home_of(robot, goal);
    (home ? at_home[*home] : on_the_way).push_back(&robot);
  }
  double radius_m = options.radius_m;
  std::vector<Members> clusters = cluster(on_the_way, world, radius_m);
  // Groups that walls keep apart stay apart however wide the radius is: it need not grow for ever.
  for (int tries = 0; clusters.size() > options.groups_max && tries < 16; ++tries) {
    radius_m *= kWider;
    clusters = cluster(on_the_way, world, radius_m);
  }
  std::vector<RobotGroup> groups;
  for (std::size_t j = 0; j < at_home.size(); ++j) {
    if (at_home[j].empty()) continue;
    const Gaussian& home = goal.components()[j].gaussian;
    groups.push_back({home, ordered_ids(at_home[j], home)});
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
    groups.push_back({*gaussian, ordered_ids(members, *gaussian)});
  }
  return groups;
}

Mixture mixture_of(std::span<const RobotGroup> groups) {
  std::size_t robots = 0;
  for (const RobotGroup& group : groups) robots += group.members.size();
  std::vector<WeightedGaussian> components;
  for (const RobotGroup& group : groups) {
    components.push_back(
        {static_cast<double>(group.members.size()) / static_cast<double>(robots), group.gaussian});
  }
  Result<Mixture> mixture = Mixture::make(std::move(components));
  SWARM_ASSERT(mixture.has_value());
  return *std::move(mixture);
}

}  // namespace swarm::planner
