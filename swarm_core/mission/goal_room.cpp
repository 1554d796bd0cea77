// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/goal_room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include <fmt/format.h>

namespace swarm {
namespace {

double smallest_radius_m(const RobotsSpec& robots) {
  double smallest_m = std::numeric_limits<double>::infinity();
  std::uint32_t grouped = 0;
  for (const RobotGroupSpec& group : robots.groups) {
    smallest_m = std::min(smallest_m, group.radius_m);
    grouped += group.count;
  }
  return grouped < robots.count ? std::min(smallest_m, robots.radius_m) : smallest_m;
}

/// The goal at the end of a mission and its path in the file.
NamedGoal last_goal(const Mission& mission) {
  NamedGoal last{&mission.goal, "goal"};
  for (std::size_t i = 0; i < mission.script.size(); ++i) {
    const auto* go_to = std::get_if<GoTo>(std::get_if<SceneChange>(&mission.script[i].action));
    if (go_to != nullptr) last = {&go_to->goal, fmt::format("script[{}].goal", i)};
  }
  return last;
}

}  // namespace

/// The perimeter of an ellipse is at most that of the circle with the same mean square radius.
std::uint32_t most_in_goal(const Gaussian& goal, double distance_m) {
  const double a_m = std::sqrt(kChiSquared2Dof99) * goal.max_sigma_m() / distance_m;
  const double b_m = std::sqrt(kChiSquared2Dof99) * goal.min_sigma_m() / distance_m;
  const double area = std::numbers::pi * a_m * b_m;
  const double perimeter = 2.0 * std::numbers::pi * std::sqrt(0.5 * (a_m * a_m + b_m * b_m));
  const double most = 2.0 / std::numbers::sqrt3 * area + 0.5 * perimeter + 1.0;
  return static_cast<std::uint32_t>(
      std::min(most, static_cast<double>(std::numeric_limits<std::uint32_t>::max())));
}

double goal_tolerance(std::uint32_t robots) {
  return std::max(2.0, 0.02 * static_cast<double>(robots));
}

std::optional<std::string> lack_of_goal_room(const Mission& mission) {
  if (mission.goal_shape != nullptr) return std::nullopt;
  return lack_of_goal_room(mission, last_goal(mission));
}

std::optional<std::string> lack_of_goal_room(const Mission& mission, const NamedGoal& goal,
                                             std::uint32_t lost) {
  const std::uint32_t robots = mission.robots.count - std::min(lost, mission.robots.count);
  const double radius_m = smallest_radius_m(mission.robots);
  constexpr std::string_view kRemedy =
      "enlarge its covariance_m2, or lower robots.count or robots.radius_m";
  // Robots that fill an area stop where they find room: the audit does not count them by component.
  const bool counted = !mission.control.shape_tolerance_m2;
  double all = 0.0;
  for (std::size_t i = 0; i < goal.mixture->components().size(); ++i) {
    const WeightedGaussian& component = goal.mixture->components()[i];
    const std::uint32_t most = most_in_goal(component.gaussian, 2.0 * radius_m);
    all += most;
    const double wanted = component.weight * robots;
    if (!counted || wanted - goal_tolerance(robots) <= most) continue;
    return fmt::format("{}[{}] has no room for {:.0f} robots of {} m radius, at most for {}; {}",
                       goal.path, i, wanted, radius_m, most, kRemedy);
  }
  if (all >= robots || goal.mixture->components().empty()) return std::nullopt;
  return fmt::format("{} has no room for {} robots of {} m radius, at most for {:.0f}; {}",
                     goal.path, robots, radius_m, all, kRemedy);
}

std::optional<std::string> lack_of_place(const Obstacle& obstacle, const Box& bounds_m) {
  Box box;
  if (const auto* circle = std::get_if<Circle>(&obstacle)) {
    const Vec2 reach_m = Vec2::Constant(circle->radius_m);
    box = {circle->center_m - reach_m, circle->center_m + reach_m};
  } else {
    const std::vector<Vec2>& corners_m = std::get<Polygon>(obstacle).vertices_m();
    box = {corners_m.front(), corners_m.front()};
    for (const Vec2& corner_m : corners_m) {
      box = {box.min_m.cwiseMin(corner_m), box.max_m.cwiseMax(corner_m)};
    }
  }
  if (bounds_m.gap_squared_m2(box) <= 0.0) return std::nullopt;
  return fmt::format(
      "the obstacle lies outside of world.bounds_m, [{}, {}, {}, {}], where no robot "
      "drives",
      bounds_m.min_m.x(), bounds_m.min_m.y(), bounds_m.max_m.x(), bounds_m.max_m.y());
}

}  // namespace swarm
