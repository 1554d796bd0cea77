// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// A path of straight segments, addressed by its arc length s ∈ [0, length] [m].
class Polyline {
 public:
  Polyline() = default;
  /// Repeated vertices are merged. \pre at least one vertex
  explicit Polyline(const std::vector<Vec2>& vertices_m);

  bool empty() const { return vertices_.empty(); }
  double length_m() const { return length_m_; }
  const std::vector<Vec2>& vertices_m() const { return vertices_; }

  struct Place {
    Vec2 point_m = Vec2::Zero();
    Vec2 tangent = Vec2::Zero();  ///< unit; zero for a path of one point
  };
  struct Segment {
    std::size_t index = 0;
    Vec2 begin_m = Vec2::Zero();
    Vec2 end_m = Vec2::Zero();
    double begin_s_m = 0.0;
    double end_s_m = 0.0;

    bool holds(double s_m) const { return begin_s_m <= s_m && s_m < end_s_m; }
    /// Of an s outside of it: its begin or end.
    Place place(double s_m) const;
  };
  /// The segment of an arc length, or of the nearest one the path has. Found the sooner the fewer
  /// segments it is from the `near`-th one.
  Segment segment(double s_m, std::size_t near = 0) const;
  Vec2 at(double s_m, std::size_t near = 0) const { return segment(s_m, near).place(s_m).point_m; }

 private:
  std::vector<Vec2> vertices_;
  std::vector<double> arc_;  // arc length at each vertex
  double length_m_ = 0.0;    // its last: asked at every tick
};

}  // namespace swarm::agent
