// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/world/plane.hpp"

namespace swarm {
namespace {

// The point of segment a + s·ab, s ∈ [0, 1], nearest to p.
double nearest_parameter(const Vec2& a, const Vec2& ab, const Vec2& p) {
  const double length_squared = ab.squaredNorm();
  if (length_squared == 0.0) return 0.0;
  return std::clamp((p - a).dot(ab) / length_squared, 0.0, 1.0);
}

// Nearest boundary point by all edges, sign by the parity of crossings: right for any simple
// polygon, and for a convex one the same as the largest half-plane distance. Vertices run
// counter-clockwise.
SignedDistance polygon_distance(std::span<const Vec2> vertices_m, const Vec2& p) {
  double best_squared = std::numeric_limits<double>::infinity();
  double best_parameter = 0.0;
  Vec2 best_offset = Vec2::Zero();
  Vec2 best_edge = Vec2::UnitX();
  bool inside = false;
  const Vec2* from = &vertices_m.back();
  for (const Vec2& to : vertices_m) {
    const Vec2 edge = to - *from;
    const double parameter = nearest_parameter(*from, edge, p);
    const Vec2 offset = p - (*from + parameter * edge);
    const double squared = offset.squaredNorm();
    if (squared < best_squared) {
      best_squared = squared;
      best_parameter = parameter;
      best_offset = offset;
      best_edge = edge;
    }
    if ((from->y() > p.y()) != (to.y() > p.y())) {
      const bool left = cross(edge, p - *from) > 0.0;
      if (left == (edge.y() > 0.0)) inside = !inside;
    }
    from = &to;
  }
  const double distance_m = std::sqrt(best_squared);
  const double sign = inside ? -1.0 : 1.0;
  const bool at_corner = best_parameter == 0.0 || best_parameter == 1.0;
  if (at_corner && distance_m > kTiny_m)
    return {sign * distance_m, sign / distance_m * best_offset};
  return {sign * distance_m, Vec2(best_edge.y(), -best_edge.x()).normalized()};
}

std::vector<ConvexEdge> edges_of(std::span<const Vec2> vertices_m) {
  std::vector<ConvexEdge> edges;
  edges.reserve(vertices_m.size());
  for (std::size_t i = 0; i < vertices_m.size(); ++i) {
    const Vec2 step = vertices_m[(i + 1) % vertices_m.size()] - vertices_m[i];
    const double length_m = step.norm();
    const Vec2 direction = step / length_m;
    edges.push_back({vertices_m[i], direction, Vec2(direction.y(), -direction.x()), length_m});
  }
  return edges;
}

// Inside, the nearest edge is the one whose line is nearest. Outside, a perpendicular foot on an
// edge that faces the point is the nearest point; if there is none, the nearest corner is.
ConvexObstacle::Faced convex_distance(std::span<const ConvexEdge> edges, const Vec2& p) {
  double farthest_m = -std::numeric_limits<double>::infinity();
  const ConvexEdge* facing = nullptr;
  for (const ConvexEdge& edge : edges) {
    const Vec2 offset = p - edge.from_m;
    const double distance_m = edge.normal.dot(offset);
    if (distance_m > 0.0) {
      const double along_m = edge.direction.dot(offset);
      if (along_m >= 0.0 && along_m <= edge.length_m) {
        return {{distance_m, edge.normal}, static_cast<int>(&edge - edges.data())};
      }
    }
    if (distance_m > farthest_m) {
      farthest_m = distance_m;
      facing = &edge;
    }
  }
  if (farthest_m <= 0.0) return {{farthest_m, facing->normal}};
  double nearest_squared = std::numeric_limits<double>::infinity();
  Vec2 nearest_offset = Vec2::Zero();
  for (const ConvexEdge& edge : edges) {
    const Vec2 offset = p - edge.from_m;
    if (offset.squaredNorm() >= nearest_squared) continue;
    nearest_squared = offset.squaredNorm();
    nearest_offset = offset;
  }
  const double distance_m = std::sqrt(nearest_squared);
  if (distance_m <= kTiny_m) return {{distance_m, facing->normal}};
  return {{distance_m, nearest_offset / distance_m}};
}

// At the centre every direction is a gradient; the x axis is as good as any.
SignedDistance circle_distance(const Circle& circle, const Vec2& p) {
  const Vec2 offset = p - circle.center_m;
  const double norm_m = offset.norm();
  return {norm_m - circle.radius_m, norm_m > 0.0 ? Vec2(offset / norm_m) : Vec2::UnitX()};
}

SignedDistance obstacle_distance(const Obstacle& obstacle, const Vec2& p) {
  if (const auto* circle = std::get_if<Circle>(&obstacle)) return circle_distance(*circle, p);
  return polygon_distance(std::get<Polygon>(obstacle).vertices_m(), p);
}

// Whether two segments cross in the interior of both; touching ends are covered by the distances
// below.
bool cross_properly(const Vec2& a, const Vec2& ab, const Vec2& c, const Vec2& cd) {
  const Vec2 ac = c - a;
  const double side_c = cross(ab, ac);
  const double side_d = cross(ab, ac + cd);
  const double side_a = cross(cd, -ac);
  const double side_b = cross(cd, ab - ac);
  return side_c * side_d < 0.0 && side_a * side_b < 0.0;
}

double segment_point_squared(const Vec2& a, const Vec2& ab, const Vec2& p) {
  return (p - a - nearest_parameter(a, ab, p) * ab).squaredNorm();
}

// Segments that do not cross are nearest at an end of one of them.
double segment_segment_squared(const Vec2& a, const Vec2& ab, const Vec2& c, const Vec2& cd) {
  if (cross_properly(a, ab, c, cd)) return 0.0;
  return std::min({segment_point_squared(a, ab, c), segment_point_squared(a, ab, c + cd),
                   segment_point_squared(c, cd, a), segment_point_squared(c, cd, a + ab)});
}

// A cheap test before the distance of segments: the gap along one axis bounds the distance from
// below.
bool boxes_apart(const Box& a, const Box& b, double gap_m) {
  return a.min_m.x() - b.max_m.x() > gap_m || b.min_m.x() - a.max_m.x() > gap_m ||
         a.min_m.y() - b.max_m.y() > gap_m || b.min_m.y() - a.max_m.y() > gap_m;
}

Box box_of(std::span<const Vec2> points_m) {
  Box box{points_m.front(), points_m.front()};
  for (const Vec2& p : points_m) {
    box.min_m = box.min_m.cwiseMin(p);
    box.max_m = box.max_m.cwiseMax(p);
  }
  return box;
}

Box box_of(const Circle& circle) {
  const Vec2 reach = Vec2::Constant(circle.radius_m);
  return {circle.center_m - reach, circle.center_m + reach};
}

// A segment is blocked if it is near an edge, or if it lies inside entirely, for which its begin is
// tested.
bool polygon_blocks(const Polygon& polygon, const Vec2& from, const Vec2& step, const Box& swept,
                    double reach_m) {
  const std::vector<Vec2>& vertices = polygon.vertices_m();
  const Vec2* a = &vertices.back();
  for (const Vec2& b : vertices) {
    const Box edge_box{a->cwiseMin(b), a->cwiseMax(b)};
    if (!boxes_apart(edge_box, swept, reach_m) &&
        segment_segment_squared(from, step, *a, b - *a) < reach_m * reach_m) {
      return true;
    }
    a = &b;
  }
  return polygon.contains(from);
}

}  // namespace

// A circle has no edges, so it has no face either.
ConvexObstacle::Faced ConvexObstacle::faced(const Vec2& point_m) const {
  if (vertices_m.empty()) return {circle_distance(circle, point_m)};
  return convex_distance(edges, point_m);
}

// Every convex part remembers the obstacle it comes from, and the boxes of obstacles and of parts
// get an index each.
Result<World> World::make(Box bounds_m, std::vector<Obstacle> obstacles,
                          std::span<const Vec2> velocities_mps, std::size_t bodies) {
  SWARM_ASSERT(velocities_mps.empty() || velocities_mps.size() == obstacles.size());
  SWARM_ASSERT(bodies <= obstacles.size());
  if (!bounds_m.min_m.allFinite() || !bounds_m.max_m.allFinite() ||
      (bounds_m.min_m.array() >= bounds_m.max_m.array()).any()) {
    return fail(ErrorCode::kBadInput, "world: bounds must be finite, min below max on both axes");
  }
  World world;
  world.bounds_m_ = bounds_m;
  std::vector<Box> boxes;
  std::vector<Box> convex_boxes;
  boxes.reserve(obstacles.size());
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    if (const auto* circle = std::get_if<Circle>(&obstacles[i])) {
      if (!circle->center_m.allFinite() || !std::isfinite(circle->radius_m) ||
          circle->radius_m <= 0.0) {
        return fail(ErrorCode::kBadInput,
                    fmt::format("world: obstacle {} is a circle without a finite centre and a "
                                "positive radius (radius {} m)",
                                i, circle->radius_m));
      }
      boxes.push_back(box_of(*circle));
      convex_boxes.push_back(boxes.back());
      world.convex_obstacles_.push_back({{}, *circle, boxes.back(), i});
      continue;
    }
    const Polygon& polygon = std::get<Polygon>(obstacles[i]);
    if (polygon.vertices_m().empty()) {
      return fail(ErrorCode::kBadInput, fmt::format("world: obstacle {} has no vertices", i));
    }
    boxes.push_back(box_of(polygon.vertices_m()));
    for (std::vector<Vec2>& part : decompose_convex(polygon)) {
      const Box box = box_of(part);
      auto edges = edges_of(part);
      convex_boxes.push_back(box);
      world.convex_obstacles_.push_back({std::move(part), {}, box, i, std::move(edges)});
    }
  }
  if (!velocities_mps.empty()) {
    for (ConvexObstacle& part : world.convex_obstacles_) {
      part.velocity_mps = velocities_mps[part.obstacle];
      world.fastest_mps_ = std::max(world.fastest_mps_, part.velocity_mps.norm());
    }
  }
  if (bodies > 0) {
    const std::size_t others = obstacles.size() - bodies;
    auto without = make(bounds_m, {obstacles.begin(), obstacles.end() - static_cast<long>(bodies)},
                        velocities_mps.first(std::min(others, velocities_mps.size())));
    SWARM_ASSERT(without.has_value());  // a part of what was checked above
    world.bodies_ = bodies;
    world.without_bodies_ = std::make_shared<const World>(*std::move(without));
  }
  world.obstacles_ = std::move(obstacles);
  world.boxes_ = BoxIndex(std::move(boxes));
  world.convex_boxes_ = BoxIndex(std::move(convex_boxes));
  return world;
}

bool World::operator==(const World& other) const {
  return bounds_m_.min_m == other.bounds_m_.min_m && bounds_m_.max_m == other.bounds_m_.max_m &&
         obstacles_ == other.obstacles_;
}

// Branch and bound: obstacles near the point give an upper bound, the index visits only boxes
// within it.
SignedDistance World::signed_distance(const Vec2& point_m) const {
  constexpr double kInfinity_m = std::numeric_limits<double>::infinity();
  double bound_m = kInfinity_m;
  boxes_.for_some_near(point_m, [&](std::uint32_t i) {
    bound_m = std::min(bound_m, obstacle_distance(obstacles_[i], point_m).distance_m);
  });
  SignedDistance best{kInfinity_m, Vec2::UnitX()};
  boxes_.for_each_within({point_m, point_m}, bound_m, [&](std::uint32_t i) {
    // Outside its box an obstacle is farther than the box, so never nearer than one that holds p.
    const double box_distance_m = boxes_.boxes()[i].distance_m(point_m);
    if (box_distance_m > 0.0 && box_distance_m >= best.distance_m) return;
    const SignedDistance candidate = obstacle_distance(obstacles_[i], point_m);
    if (candidate.distance_m < best.distance_m) best = candidate;
  });
  return best;
}

// Cheaper than signed_distance() where only near obstacles matter: the bound is known from the
// start.
[[gnu::hot]] double World::distance_up_to_m(const Vec2& point_m, double most_m) const {
  double least_m = most_m;
  boxes_.for_each_within({point_m, point_m}, most_m, [&](std::uint32_t i) {
    least_m = std::min(least_m, obstacle_distance(obstacles_[i], point_m).distance_m);
  });
  return least_m;
}

// An obstacle is farther than the clearance if and only if all its convex parts are, and distances
// to parts are cheaper because their edges are precomputed.
[[gnu::hot]] bool World::is_clear(const Vec2& point_m, double clearance_m) const {
  return !convex_boxes_.any_within({point_m, point_m}, clearance_m, [&](std::uint32_t i) {
    return convex_obstacles_[i].signed_distance(point_m).distance_m <= clearance_m;
  });
}

bool World::segment_is_free(const Vec2& from_m, const Vec2& to_m, double clearance_m) const {
  // A segment at exactly the clearance is free, whatever the rounding; one that touches is not.
  const double reach_m = std::max(clearance_m - kTiny_m, kTiny_m);
  const Box swept{from_m.cwiseMin(to_m), from_m.cwiseMax(to_m)};
  const Vec2 step = to_m - from_m;
  return !boxes_.any_within(swept, reach_m, [&](std::uint32_t i) {
    if (const auto* circle = std::get_if<Circle>(&obstacles_[i])) {
      const double blocked_m = circle->radius_m + reach_m;
      return segment_point_squared(from_m, step, circle->center_m) < blocked_m * blocked_m;
    }
    return polygon_blocks(std::get<Polygon>(obstacles_[i]), from_m, step, swept, reach_m);
  });
}

}  // namespace swarm
