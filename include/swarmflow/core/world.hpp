// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "swarmflow/core/box.hpp"
#include "swarmflow/core/box_index.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/polygon.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm {

/// A disc, world frame.
struct Circle {
  Vec2 center_m = Vec2::Zero();  ///< its centre [m]
  double radius_m = 0.0;         ///< its radius, > 0 within a World [m]
  /// Whether centre and radius are the same to the last bit.
  bool operator==(const Circle&) const = default;
};

/// An obstacle as the mission file gives it; polygons need not be convex.
using Obstacle = std::variant<Polygon, Circle>;

/// Signed distance s(p, O) of a point to an obstacle, and its gradient [SwarmPRM, eq. 9].
struct SignedDistance {
  double distance_m = 0.0;  ///< s: positive outside, negative inside (depth of penetration) [m]
  /// n = ∇s: the unit vector that points from the obstacle towards free space. Where it is not
  /// unique (medial axis, centre of a circle) one of its valid values.
  Vec2 gradient = Vec2::Zero();
};

/// An edge of a convex polygon with what distances to it need, computed once.
struct ConvexEdge {
  Vec2 from_m = Vec2::Zero();     ///< where it begins, counter-clockwise [m]
  Vec2 direction = Vec2::Zero();  ///< unit vector along it
  Vec2 normal = Vec2::Zero();     ///< unit vector out of the polygon
  double length_m = 0.0;          ///< its length, > 0 [m]
};

/// A convex obstacle, or a convex part of one: the unit of the CVaR test and of the safety filter.
/// World::make() fills it in; the members depend on each other.
struct ConvexObstacle {
  std::vector<Vec2> vertices_m;     ///< counter-clockwise; empty for a circle
  Circle circle;                    ///< used when `vertices_m` is empty
  Box box;                          ///< smallest box around it [m]
  std::size_t obstacle = 0;         ///< index into World::obstacles() of the obstacle it is part of
  std::vector<ConvexEdge> edges{};  ///< of the polygon, counter-clockwise; empty for a circle
  Vec2 velocity_mps = Vec2::Zero();  ///< of the obstacle at the time of the map [m/s]

  /// Signed distance of a point to it, exact inside and outside. O(edges) with two products each
  /// and at most one root; does not allocate. The planner's most frequent call.
  SignedDistance signed_distance(const Vec2& point_m) const {
    return faced(point_m).signed_distance;
  }

  /// Value of Faced::face where the nearest point is not on an edge.
  static constexpr int kNoFace = -1;
  /// A signed distance and the edge that it was taken from.
  struct Faced {
    SignedDistance signed_distance;  ///< as signed_distance() returns it
    /// Index into `edges` of the edge with the nearest point; kNoFace where that is a corner, for a
    /// circle and for a point inside.
    int face = kNoFace;
  };
  /// Signed distance of a point and, for a point outside, the edge it faces. All points that face
  /// the same edge form a convex set, in which the distance is that to the edge's line: the check
  /// of two ends covers the segment between them. Cost as of signed_distance().
  Faced faced(const Vec2& point_m) const;
};

/// The map at one moment: a rectangle with obstacles, which may touch and overlap.
///
/// Immutable once made, apart from assignment: a map that changed is another World. Queries do not
/// allocate unless more than 64 obstacles are near, and may run in several threads at once. They
/// cost O(log n) for n obstacles and a scan of the edges of those nearby.
class World {
 public:
  /// A world without obstacles, its bounds the single point (0, 0).
  World() = default;

  /// Makes a map: decomposes polygons into convex parts and builds the search trees.
  /// \param bounds_m the rectangle robots stay in [m]
  /// \param obstacles obstacles in any order; they may reach beyond the bounds
  /// \param velocities_mps velocity of each obstacle [m/s]; empty: nothing moves
  /// \param bodies number of obstacles at the end of the list that are bodies of dead robots
  /// \return kBadInput for a rectangle that is empty or not finite, circles without a finite centre
  ///   and a positive, finite radius, and polygons without vertices
  /// \pre velocities_mps is empty or has the size of obstacles, and bodies ≤ obstacles.size();
  ///   asserted
  static Result<World> make(Box bounds_m, std::vector<Obstacle> obstacles,
                            std::span<const Vec2> velocities_mps = {}, std::size_t bodies = 0);

  /// Whether both have the same rectangle and the same obstacles in the same order, to the last
  /// bit. Velocities and the number of bodies are not compared.
  bool operator==(const World& other) const;

  /// The rectangle that robots stay in [m].
  const Box& bounds_m() const { return bounds_m_; }
  /// All obstacles, in the order given to make().
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }

  /// The obstacles that are bodies of dead robots, the last ones of obstacles(). They are small
  /// compared with a plan's Gaussians: each robot avoids them on its own path.
  std::span<const Obstacle> bodies() const { return std::span(obstacles_).last(bodies_); }
  /// The map without the bodies of dead robots; valid as long as this one.
  const World& without_bodies() const { return without_bodies_ ? *without_bodies_ : *this; }

  /// The obstacles, non-convex ones decomposed into convex parts; in the order of obstacles().
  const std::vector<ConvexObstacle>& convex_obstacles() const { return convex_obstacles_; }

  /// Speed of the fastest obstacle, 0 if none moves [m/s].
  double fastest_mps() const { return fastest_mps_; }

  /// Index over the boxes of convex_obstacles(), with the same indices, for queries about those
  /// near a point.
  const BoxIndex& convex_boxes() const { return convex_boxes_; }

  /// Signed distance to the nearest obstacle [SwarmPRM, eq. 9]. Exact outside and inside a single
  /// obstacle; inside several that overlap it is that of the deepest one, so the depth to free
  /// space may be larger. Distance +∞ in a world without obstacles. Of obstacles at the same
  /// distance the first in obstacles() counts. The bounds are not an obstacle.
  SignedDistance signed_distance(const Vec2& point_m) const;
  /// The distance of signed_distance() alone [m].
  double distance_m(const Vec2& point_m) const { return signed_distance(point_m).distance_m; }

  /// min(distance_m(point_m), most_m) [m]: cheaper, since nearly all obstacles are ruled out by
  /// their box. \pre most_m ≥ 0; not checked
  double distance_up_to_m(const Vec2& point_m, double most_m) const;

  /// Whether the point is farther than `clearance_m` from every obstacle. Cheaper still.
  /// \pre clearance_m ≥ 0; not checked
  bool is_clear(const Vec2& point_m, double clearance_m) const;

  /// Whether every point of the segment is at least `clearance_m` from every obstacle: line of
  /// sight for a disc of that radius. Exact up to 1 nm, from distances between segments, so the
  /// cost does not depend on the segment's length. At clearance 0 a segment that touches an
  /// obstacle is not free. \pre clearance_m ≥ 0; not checked
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
