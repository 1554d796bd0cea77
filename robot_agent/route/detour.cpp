// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/route/detour.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace swarm::agent {
namespace {

constexpr int kDeep = 6;            // recursion depth of bends, and passes of free_position()
constexpr double kBetween_m = 0.3;  // width beyond its own of a gap that a robot passes
constexpr double kSkim_m = 0.1;     // clearance from bodies on the lines of a bend
constexpr double kWall_m = 0.05;    // clearance from obstacles that are no bodies
constexpr double kLeast_m = 1e-6;
constexpr double kRounding = 0.99;  // a path bent at exactly kSkim_m is not blocked

/// The computation for one pair of world and options: collects the bodies once.
class Detour {
 public:
  Detour(const World& world, const DetourOptions& options) : world_(world), options_(options) {
    for (const Obstacle& body : world.bodies()) {
      if (const auto* circle = std::get_if<Circle>(&body)) bodies_.push_back(*circle);
    }
  }

  // Replaces the line by a bend around the first body on it, and each line of that in turn. Tries
  // the shorter side first; if neither side is free of walls, the line stays.
  void bend(const Vec2& from_m, const Vec2& to_m, double touch_m, int deep,
            std::vector<Vec2>& points) const {
    const std::optional<std::size_t> first = first_on(from_m, to_m, touch_m);
    if (!first || deep == 0) return;
    for (const bool shorter_side : {true, false}) {
      const std::vector<Vec2> bent = around(from_m, to_m, *first, shorter_side);
      if (!is_free(from_m, bent, to_m)) continue;
      Vec2 at_m = from_m;
      for (const Vec2& next_m : bent) {
        bend(at_m, next_m, options_.scale * kSkim_m, deep - 1, points);
        points.push_back(next_m);
        at_m = next_m;
      }
      bend(at_m, to_m, options_.scale * kSkim_m, deep - 1, points);
      return;
    }
  }

  // Whether a body is on the line, or at one of its ends.
  bool blocks(const Vec2& from_m, const Vec2& to_m) const {
    const double clearance_m = options_.radius_m + kRounding * options_.scale * kSkim_m;
    return std::any_of(bodies_.begin(), bodies_.end(), [&](const Circle& body) {
      return distance_m(body.center_m, from_m, to_m) < body.radius_m + clearance_m;
    });
  }

  // Pushes a point out of all bodies in turn, in several passes since one push may lead into
  // another body. The result counts only if it is free; otherwise the point stays.
  Vec2 free_position(const Vec2& point_m) const {
    Vec2 p = point_m;
    for (int pass = 0; pass < kDeep; ++pass) {
      for (const Circle& body : bodies_) {
        const double wanted_m = body.radius_m + options_.radius_m + options_.touch_m;
        const Vec2 off = p - body.center_m;
        if (off.norm() >= wanted_m) continue;
        p = body.center_m + wanted_m * (off.norm() > kLeast_m ? off.normalized() : Vec2::UnitX());
      }
    }
    const bool moved = p != point_m;
    return moved && inside(p) && world_.is_clear(p, options_.radius_m + options_.scale * kWall_m)
               ? p
               : point_m;
  }

 private:
  static double distance_m(const Vec2& p, const Vec2& from_m, const Vec2& to_m) {
    const Vec2 line = to_m - from_m;
    const double along =
        std::clamp((p - from_m).dot(line) / std::max(line.squaredNorm(), kLeast_m), 0.0, 1.0);
    return (p - from_m - along * line).norm();
  }

  /// The first body that the line comes too near to.
  std::optional<std::size_t> first_on(const Vec2& from_m, const Vec2& to_m, double touch_m) const {
    const Vec2 line = to_m - from_m;
    const double length_m = line.norm();
    if (length_m < kLeast_m) return std::nullopt;
    std::optional<std::size_t> first;
    double first_m = length_m;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const double along_m =
          std::clamp((bodies_[i].center_m - from_m).dot(line) / length_m, 0.0, length_m);
      const Vec2 nearest_m = from_m + along_m / length_m * line;
      const double wanted_m = bodies_[i].radius_m + options_.radius_m + touch_m;
      // A body beside an end point of the line cannot be bent around: the end stays.
      if (along_m <= 0.0 || along_m >= length_m || along_m >= first_m) continue;
      if ((bodies_[i].center_m - nearest_m).norm() >= wanted_m) continue;
      first = i;
      first_m = along_m;
    }
    return first;
  }

  /// Adds a body and, one after the other, all bodies with a gap to a member that a robot does not
  /// fit through. O(bodies²).
  void grow(std::vector<std::size_t>& members, std::size_t by) const {
    std::size_t looked_at = members.size();
    members.push_back(by);
    for (; looked_at < members.size(); ++looked_at) {
      const Circle& a = bodies_[members[looked_at]];
      for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const double gap_m =
            (bodies_[i].center_m - a.center_m).norm() - bodies_[i].radius_m - a.radius_m;
        if (gap_m < 2.0 * options_.radius_m + options_.scale * kBetween_m &&
            !contains(members, i)) {
          members.push_back(i);
        }
      }
    }
  }

  static bool contains(const std::vector<std::size_t>& members, std::size_t i) {
    return std::find(members.begin(), members.end(), i) != members.end();
  }

  /// A body too near to one of the points that is not a member yet.
  std::optional<std::size_t> body_at(const std::vector<Vec2>& points,
                                     const std::vector<std::size_t>& members) const {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const double wanted_m = bodies_[i].radius_m + options_.radius_m + options_.touch_m;
      const bool is_there = std::any_of(points.begin(), points.end(), [&](const Vec2& p) {
        return (p - bodies_[i].center_m).norm() < wanted_m;
      });
      if (is_there && !contains(members, i)) return i;
    }
    return std::nullopt;
  }

  /// The points beside the cluster of a body. Bodies in the place of the points join the cluster,
  /// until there are none.
  std::vector<Vec2> around(const Vec2& from_m, const Vec2& to_m, std::size_t first,
                           bool shorter_side) const {
    std::vector<std::size_t> members;
    grow(members, first);
    for (;;) {
      std::vector<Vec2> points = beside(from_m, to_m, members, shorter_side);
      const auto also = body_at(points, members);
      if (!also) return points;
      grow(members, *also);
    }
  }

  /// One point beside the members, or two beside a long row of them.
  std::vector<Vec2> beside(const Vec2& from_m, const Vec2& to_m,
                           const std::vector<std::size_t>& members, bool shorter_side) const {
    const double length_m = (to_m - from_m).norm();
    const Vec2 along = (to_m - from_m) / length_m;
    const Vec2 left(-along.y(), along.x());
    double begin_m = length_m, end_m = 0.0, left_m = 0.0, right_m = 0.0;
    for (const std::size_t i : members) {
      const double wanted_m = bodies_[i].radius_m + options_.radius_m + options_.keep_m;
      const Vec2 off = bodies_[i].center_m - from_m;
      begin_m = std::min(begin_m, std::max(0.0, off.dot(along)));
      end_m = std::max(end_m, std::min(length_m, off.dot(along)));
      left_m = std::max(left_m, off.dot(left) + wanted_m);
      right_m = std::min(right_m, off.dot(left) - wanted_m);
    }
    // Offsets to the left of the line are positive.
    const double aside_m = (left_m <= -right_m) == shorter_side ? left_m : right_m;
    std::vector<Vec2> points = {from_m + begin_m * along + aside_m * left};
    if (end_m - begin_m > options_.radius_m) {
      points.push_back(from_m + end_m * along + aside_m * left);
    }
    return points;
  }

  // Whether the lines through the points are free of walls; bodies on them are bent around later.
  bool is_free(const Vec2& from_m, const std::vector<Vec2>& points, const Vec2& to_m) const {
    const double clearance_m = options_.radius_m + options_.scale * kWall_m;
    const World& walls = world_.without_bodies();
    Vec2 at_m = from_m;
    for (const Vec2& next_m : points) {
      if (!inside(next_m) || !walls.segment_is_free(at_m, next_m, clearance_m)) return false;
      at_m = next_m;
    }
    return walls.segment_is_free(at_m, to_m, clearance_m);
  }

  bool inside(const Vec2& p) const {
    const Box& bounds = world_.bounds_m();
    return ((p - bounds.min_m).array() >= options_.radius_m).all() &&
           ((bounds.max_m - p).array() >= options_.radius_m).all();
  }

  const World& world_;
  DetourOptions options_;
  std::vector<Circle> bodies_;
};

}  // namespace

DetourOptions detour_options(const RouteOptions& route) {
  return {.radius_m = route.radius_m,
          .touch_m = route.leg_clearance_m,
          .keep_m = route.scale * DetourOptions{}.keep_m,
          .scale = route.scale};
}

std::vector<Vec2> around_bodies(const Vec2& from_m, const Vec2& to_m, const World& world,
                                const DetourOptions& options) {
  std::vector<Vec2> points;
  if (world.bodies().empty()) return points;
  Detour(world, options).bend(from_m, to_m, options.touch_m, kDeep, points);
  return points;
}

Vec2 beside_bodies(const Vec2& point_m, const World& world, const DetourOptions& options) {
  return world.bodies().empty() ? point_m : Detour(world, options).free_position(point_m);
}

bool is_blocked_by_body(const Polyline& path, double from_s_m, const World& world,
                        const DetourOptions& options) {
  if (path.empty() || world.bodies().empty()) return false;
  const Detour detour(world, options);
  const std::vector<Vec2>& vertices_m = path.vertices_m();
  const double begin_s_m = std::clamp(from_s_m, 0.0, path.length_m());
  Vec2 at_m = path.at(begin_s_m);
  for (std::size_t i = path.segment(begin_s_m).index + 1; i < vertices_m.size(); ++i) {
    if (detour.blocks(at_m, vertices_m[i])) return true;
    at_m = vertices_m[i];
  }
  return detour.blocks(at_m, at_m);
}

}  // namespace swarm::agent
