// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarm_core/base/linalg.hpp"

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
    std::size_t segment = 0;
  };
  /// Found the sooner the fewer segments it is from segment `near`.
  Place place(double s_m, std::size_t near = 0) const;
  Vec2 at(double s_m, std::size_t near = 0) const { return place(s_m, near).point_m; }

 private:
  std::size_t segment_of(double s_m, std::size_t near) const;
  std::vector<Vec2> vertices_;
  std::vector<double> arc_;  // arc length at each vertex
  double length_m_ = 0.0;    // its last: asked at every tick
};

}  // namespace swarm::agent
