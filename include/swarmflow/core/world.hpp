// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/box.hpp"
#include "swarmflow/core/box_index.hpp"
#include "swarmflow/core/polygon.hpp"

namespace swarm {

struct Circle {
  Vec2 center_m = Vec2::Zero();
  double radius_m = 0.0;
  bool operator==(const Circle&) const = default;
};

/// An obstacle as the mission file gives it.
using Obstacle = std::variant<Polygon, Circle>;

/// Signed distance to an obstacle, positive outside [m], and its gradient: a unit vector that
/// points from the obstacle towards free space. At a corner's medial axis any of the valid
/// gradients.
struct SignedDistance {
  double distance_m = 0.0;
  Vec2 gradient = Vec2::Zero();
};

/// An edge of a convex polygon, ready for distances: from `from_m` for `length_m` along
/// `direction`, the outside where `normal` points.
struct ConvexEdge {
  Vec2 from_m = Vec2::Zero();
  Vec2 direction = Vec2::Zero();
  Vec2 normal = Vec2::Zero();
  double length_m = 0.0;
};

/// A convex obstacle: what the CVaR test and the safety filter see.
struct ConvexObstacle {
  std::vector<Vec2> vertices_m;  ///< counter-clockwise; empty for a circle
  Circle circle;                 ///< used when `vertices_m` is empty
  Box box;
  std::size_t obstacle = 0;          ///< index into World::obstacles() of what this is a part of
  std::vector<ConvexEdge> edges{};   ///< of the polygon; empty for a circle
  Vec2 velocity_mps = Vec2::Zero();  ///< at the moment the map is of
  /// Exact; O(edges), two products each and rarely a root: the planner asks this most of all.
  SignedDistance signed_distance(const Vec2& point_m) const {
    return faced(point_m).signed_distance;
  }

  static constexpr int kNoFace = -1;
  struct Faced {
    SignedDistance signed_distance;
    int face = kNoFace;  ///< index of the edge that holds the nearest point; none at a corner
  };
  /// From a point outside, also which edge it faces. All points that face an edge form a convex
  /// set, and there the distance is that to the edge's line.
  Faced faced(const Vec2& point_m) const;
};

/// The map at a moment: a rectangle with obstacles, which may touch and overlap.
class World {
 public:
  /// A world without obstacles and extent.
  World() = default;

  /// Refuses an empty or non-finite rectangle and circles without a positive, finite radius.
  /// `velocities_mps` is empty (nothing moves) or has one for each obstacle. The last `bodies`
  /// obstacles are those of fallen robots.
  static Result<World> make(Box bounds_m, std::vector<Obstacle> obstacles,
                            std::span<const Vec2> velocities_mps = {}, std::size_t bodies = 0);

  /// Whether it is the same rectangle with the same obstacles in the same order, to the last bit.
  bool operator==(const World& other) const;

  const Box& bounds_m() const { return bounds_m_; }
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }

  /// Those of them that are bodies of fallen robots. They are small against a plan: each robot gets
  /// around them by itself.
  std::span<const Obstacle> bodies() const { return std::span(obstacles_).last(bodies_); }
  /// The map without them.
  const World& without_bodies() const { return without_bodies_ ? *without_bodies_ : *this; }

  /// The obstacles, non-convex ones decomposed into convex parts.
  const std::vector<ConvexObstacle>& convex_obstacles() const { return convex_obstacles_; }

  /// Speed of the fastest obstacle [m/s].
  double fastest_mps() const { return fastest_mps_; }

  /// The boxes of the convex obstacles, for what asks only about those near a place.
  const BoxIndex& convex_boxes() const { return convex_boxes_; }

  /// Signed distance to the nearest obstacle: exact outside and, where obstacles do not overlap,
  /// inside; ≥ the true penetration where they do. +∞ distance in a world without obstacles.
  /// Of obstacles at the same distance the first counts.
  SignedDistance signed_distance(const Vec2& point_m) const;
  double distance_m(const Vec2& point_m) const { return signed_distance(point_m).distance_m; }

  /// The distance, or `most_m` ≥ 0 where it is larger: cheaper, since nearly all obstacles are
  /// ruled out by their box.
  double distance_up_to_m(const Vec2& point_m, double most_m) const;

  /// Whether the point is farther than `clearance_m` ≥ 0 from every obstacle. Cheaper still.
  bool is_clear(const Vec2& point_m, double clearance_m) const;

  /// Whether every point of the segment is at least `clearance_m` ≥ 0 from every obstacle. Exact up
  /// to 1 nm, from distances between segments: O(edges) of those near, also along a wall. Touching
  /// at clearance 0 is not free.
  bool segment_is_free(const Vec2& from_m, const Vec2& to_m, double clearance_m) const;

 private:
  Box bounds_m_;
  std::vector<Obstacle> obstacles_;
  std::vector<ConvexObstacle> convex_obstacles_;
  double fastest_mps_ = 0.0;
  BoxIndex boxes_;         // of obstacles_
  BoxIndex convex_boxes_;  // of convex_obstacles_
  std::size_t bodies_ = 0;
  std::shared_ptr<const World> without_bodies_;  // null: there are none
};

}  // namespace swarm
