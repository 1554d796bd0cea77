// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/to_message.hpp"

#include <variant>

namespace swarm::link {

// Copies nodes and legs one to one: indices of nodes keep their meaning.
PlanMessage to_message(const FlowPlan& plan, PlannerEpoch epoch, PlanVersion version, UtcTime t0) {
  PlanMessage message{.version = version.value(),
                      .epoch = epoch.value(),
                      .t0_utc_ns = t0.time_since_epoch().count()};
  message.nodes.reserve(plan.nodes().size());
  for (const auto& node : plan.nodes()) {
    const auto& mean_m = node.gaussian.mean_m();
    const auto& covariance_m2 = node.gaussian.covariance_m2();
    message.nodes.push_back({.mean_x_m = mean_m.x(),
                             .mean_y_m = mean_m.y(),
                             .covariance_xx_m2 = covariance_m2(0, 0),
                             .covariance_xy_m2 = covariance_m2(0, 1),
                             .covariance_yy_m2 = covariance_m2(1, 1),
                             .time_s = node.time.count(),
                             .mass = node.mass});
  }
  message.legs.reserve(plan.legs().size());
  for (const auto& leg : plan.legs()) {
    message.legs.push_back({.from_node = leg.from, .to_node = leg.to, .mass = leg.mass});
  }
  return message;
}

// Polygons append their corners to the common list of vertices, in the order of the obstacles.
SceneMessage to_message(const Scene& scene) {
  SceneMessage message{.version = scene.version,
                       .risk_alpha = scene.risk_alpha.value_or(0.0),
                       .next_id = scene.next_id,
                       .removed = scene.removed};
  for (const SceneObstacle& o : scene.obstacles) {
    SceneObstacleMessage& out = message.obstacles.emplace_back();
    out.obstacle_id = o.id;
    if (o.owner) out.owner_robot_id = o.owner->value();
    out.velocity_x_mps = o.velocity_mps.x();
    out.velocity_y_mps = o.velocity_mps.y();
    out.moving_from_utc_ns = o.moving_from.time_since_epoch().count();
    out.moving_until_utc_ns = o.moving_until.time_since_epoch().count();
    if (const auto* circle = std::get_if<Circle>(&o.shape)) {
      out.center = {circle->center_m.x(), circle->center_m.y()};
      out.radius_m = circle->radius_m;
      continue;
    }
    const auto& vertices = std::get<Polygon>(o.shape).vertices_m();
    out.vertices = static_cast<std::uint32_t>(vertices.size());
    for (const Vec2& v : vertices) message.vertices.push_back({v.x(), v.y()});
  }
  if (!scene.goal) return message;
  for (const auto& [weight, gaussian] : scene.goal->components()) {
    const Mat2& c = gaussian.covariance_m2();
    message.goal.push_back({.mean_x_m = gaussian.mean_m().x(),
                            .mean_y_m = gaussian.mean_m().y(),
                            .covariance_xx_m2 = c(0, 0),
                            .covariance_xy_m2 = c(0, 1),
                            .covariance_yy_m2 = c(1, 1),
                            .weight = weight});
  }
  return message;
}

}  // namespace swarm::link
