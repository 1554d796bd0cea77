// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "swarm_core/base/stamp.hpp"
#include "swarm_link/gate/content_checks.hpp"
#include "swarm_link/gate/number_tests.hpp"
#include "swarm_link/wire_bounds.hpp"
#include "swarmflow/mission/sections/planner.hpp"

namespace swarm::link {
namespace {

// Larger coordinates or speeds are not plausible for ground robots and would lose precision.
constexpr double kMaxCoordinate_m = Scene::kMaxCoordinate_m;
constexpr double kMaxSpeed_mps = Scene::kMaxSpeed_mps;

bool is_place(const PointMessage& p) {
  // False for NaN as well.
  return std::abs(p.x_m) <= kMaxCoordinate_m && std::abs(p.y_m) <= kMaxCoordinate_m;
}

// A circle if the obstacle has no vertices, else a polygon of the given ones.
Checked<Obstacle> to_shape(const SceneObstacleMessage& message,
                           std::span<const PointMessage> vertices) {
  if (message.vertices == 0) {
    if (!is_place(message.center) ||
        !(message.radius_m > 0.0 && message.radius_m <= kMaxCoordinate_m)) {
      return refuse(RefusalReason::kOutOfRange);
    }
    return Circle{.center_m = {message.center.x_m, message.center.y_m},
                  .radius_m = message.radius_m};
  }
  std::vector<Vec2> corners;
  for (const PointMessage& p : vertices) {
    if (!is_place(p)) return refuse(RefusalReason::kOutOfRange);
    corners.emplace_back(p.x_m, p.y_m);
  }
  auto polygon = Polygon::make(std::move(corners));
  if (!polygon) return refuse(RefusalReason::kOutOfRange);
  return std::move(*polygon);
}

/// A robot's body is a circle at rest whose obstacle id is derived from the robot's id.
bool is_body(const SceneObstacleMessage& o, const WireLimits& limits) {
  return o.owner_robot_id < limits.robots && o.obstacle_id == body_id(RobotId(o.owner_robot_id)) &&
         o.vertices == 0 && o.velocity_x_mps == 0.0 && o.velocity_y_mps == 0.0;
}

// Obstacles take their vertices from the common list in order; none may remain.
Checked<std::vector<SceneObstacle>> to_obstacles(const SceneMessage& message,
                                                 const WireLimits& limits) {
  std::vector<SceneObstacle> obstacles;
  std::span<const PointMessage> vertices_left(message.vertices);
  for (const SceneObstacleMessage& o : message.obstacles) {
    const bool ordered = obstacles.empty() || obstacles.back().id < o.obstacle_id;
    const bool slow = std::hypot(o.velocity_x_mps, o.velocity_y_mps) <= kMaxSpeed_mps;
    const bool owned = o.owner_robot_id != kNoRobot;
    const bool known = owned ? is_body(o, limits) : o.obstacle_id < message.next_id;
    const bool dated = is_stamp(o.moving_from_utc_ns) && is_stamp(o.moving_until_utc_ns);
    if (!ordered || !slow || !known || !dated || o.moving_from_utc_ns > o.moving_until_utc_ns ||
        o.vertices > vertices_left.size()) {
      return refuse(RefusalReason::kOutOfRange);
    }
    auto shape = to_shape(o, vertices_left.first(o.vertices));
    if (!shape) return refuse(shape.error());
    vertices_left = vertices_left.subspan(o.vertices);
    obstacles.push_back({.id = o.obstacle_id,
                         .owner = owned ? std::optional(RobotId(o.owner_robot_id)) : std::nullopt,
                         .shape = std::move(*shape),
                         .velocity_mps = {o.velocity_x_mps, o.velocity_y_mps},
                         .moving_from = UtcTime(Duration(o.moving_from_utc_ns)),
                         .moving_until = UtcTime(Duration(o.moving_until_utc_ns))});
  }
  if (!vertices_left.empty()) return refuse(RefusalReason::kOutOfRange);
  return obstacles;
}

// Empty in the message: the goal of the mission file is still valid.
Checked<std::optional<Mixture>> to_goal(const SceneMessage& message) {
  if (message.goal.empty()) return std::optional<Mixture>();
  std::vector<WeightedGaussian> components;
  for (const GoalComponentMessage& c : message.goal) {
    if (!is_place({c.mean_x_m, c.mean_y_m})) return refuse(RefusalReason::kOutOfRange);
    Mat2 covariance_m2;
    covariance_m2 << c.covariance_xx_m2, c.covariance_xy_m2, c.covariance_xy_m2, c.covariance_yy_m2;
    const auto gaussian = Gaussian::make({c.mean_x_m, c.mean_y_m}, covariance_m2);
    if (!gaussian || !is_well_shaped(covariance_m2)) return refuse(RefusalReason::kBadGaussian);
    components.push_back({c.weight, *gaussian});
  }
  auto mixture = Mixture::make(std::move(components));
  if (!mixture) return refuse(RefusalReason::kBadMass);
  return std::optional<Mixture>(std::move(*mixture));
}

}  // namespace

// Ids from kFirstBodyId on are reserved for bodies of robots. A risk level of 0 stands for "as in
// the mission file".
Checked<Scene> check_scene(const SceneMessage& message, const WireLimits& limits) {
  if (message.schema_version != kSchemaVersion) return refuse(RefusalReason::kSchema);
  if (!fits_wire(message)) return refuse(RefusalReason::kOversized);
  if (message.next_id > kFirstBodyId) return refuse(RefusalReason::kOutOfRange);
  if (message.risk_alpha != 0.0 && !kRiskAlphaRange.contains(message.risk_alpha)) {
    return refuse(RefusalReason::kOutOfRange);
  }
  auto obstacles = to_obstacles(message, limits);
  if (!obstacles) return refuse(obstacles.error());
  auto goal = to_goal(message);
  if (!goal) return refuse(goal.error());
  Scene scene{.version = message.version,
              .removed = message.removed,
              .obstacles = std::move(*obstacles),
              .next_id = message.next_id,
              .goal = std::move(*goal),
              .risk_alpha = std::nullopt};
  if (message.risk_alpha > 0.0) scene.risk_alpha = message.risk_alpha;
  return scene;
}

}  // namespace swarm::link
