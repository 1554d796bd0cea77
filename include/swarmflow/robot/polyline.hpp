// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// A path of straight segments, parametrised by its arc length s ∈ [0, length] [m]. World frame.
/// Immutable once made, apart from assignment.
class Polyline {
 public:
  /// A path without vertices, of length 0; segment() and at() must not be called.
  Polyline() = default;
  /// The path through these points. A vertex within 1 µm of the one before is dropped. Allocates.
  /// \pre at least one vertex, asserted
  explicit Polyline(const std::vector<Vec2>& vertices_m);

  /// Whether the path has no vertices, as after default construction.
  bool empty() const { return vertices_.empty(); }
  /// Its arc length, 0 for a path of one point [m].
  double length_m() const { return length_m_; }
  /// Its vertices without repeated ones [m].
  const std::vector<Vec2>& vertices_m() const { return vertices_; }

  /// A point of the path.
  struct Position {
    Vec2 point_m = Vec2::Zero();  ///< its position [m]
    Vec2 tangent = Vec2::Zero();  ///< unit vector along the path; zero for a path of one point
  };
  /// A straight part of the path, copied, so that it can be kept between ticks.
  struct Segment {
    std::size_t index = 0;        ///< of its first vertex
    Vec2 begin_m = Vec2::Zero();  ///< its first vertex [m]
    Vec2 end_m = Vec2::Zero();    ///< its last vertex [m]
    double begin_s_m = 0.0;       ///< arc length of the first vertex [m]
    double end_s_m = 0.0;         ///< arc length of the last vertex [m]

    /// Whether an arc length [m] belongs to it: begin_s_m ≤ s < end_s_m.
    bool holds(double s_m) const { return begin_s_m <= s_m && s_m < end_s_m; }
    /// The point at an arc length [m]; for an s outside of the segment its begin or end.
    Position position(double s_m) const;
    /// The same without the tangent, which costs two divisions.
    Vec2 point_m(double s_m) const;
  };
  /// The segment that holds an arc length, or the first or last one for an s outside [0, length].
  /// O(segments between the `near`-th one and the answer), does not allocate.
  /// \param s_m arc length [m]
  /// \param near index of the segment to search from, such as that of the last tick
  /// \pre the path is not empty; not checked
  Segment segment(double s_m, std::size_t near = 0) const;
  /// The position at an arc length [m]; cost and precondition as of segment().
  Vec2 at(double s_m, std::size_t near = 0) const { return segment(s_m, near).point_m(s_m); }

 private:
  std::vector<Vec2> vertices_;
  std::vector<double> arc_;  // arc length at each vertex
  double length_m_ = 0.0;    // the last of arc_: read at every tick
};

}  // namespace swarm::agent
