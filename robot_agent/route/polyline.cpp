// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/polyline.hpp"

#include <algorithm>

#include "swarm_core/base/assert.hpp"

namespace swarm::agent {

/// Arc lengths by a running sum; vertices nearer than 1 µm to the last one are dropped, as they
/// have no tangent.
Polyline::Polyline(const std::vector<Vec2>& vertices_m) {
  SWARM_ASSERT(!vertices_m.empty());
  for (const Vec2& v : vertices_m) {
    const double step = vertices_.empty() ? 0.0 : (v - vertices_.back()).norm();
    if (!vertices_.empty() && step < 1e-6) continue;
    arc_.push_back(vertices_.empty() ? 0.0 : arc_.back() + step);
    vertices_.push_back(v);
  }
  length_m_ = arc_.back();
}

/// Linear search from `near`: successive queries are close to each other, so a few steps are
/// enough.
[[gnu::hot]] Polyline::Segment Polyline::segment(double s_m, std::size_t near) const {
  if (vertices_.size() == 1) return {.begin_m = vertices_.front(), .end_m = vertices_.front()};
  std::size_t i = std::min(near, arc_.size() - 2);
  while (i + 2 < arc_.size() && arc_[i + 1] <= s_m) ++i;
  while (i > 0 && arc_[i] > s_m) --i;
  return {i, vertices_[i], vertices_[i + 1], arc_[i], arc_[i + 1]};
}

[[gnu::hot]] Vec2 Polyline::Segment::point_m(double s_m) const {
  const double length_m = end_s_m - begin_s_m;
  if (length_m <= 0.0) return begin_m;
  const double t = (std::clamp(s_m, begin_s_m, end_s_m) - begin_s_m) / length_m;
  return (1.0 - t) * begin_m + t * end_m;
}

/// A path of one vertex has no direction: its tangent is 0.
[[gnu::hot]] Polyline::Position Polyline::Segment::position(double s_m) const {
  const double length_m = end_s_m - begin_s_m;
  if (length_m <= 0.0) return {begin_m, Vec2::Zero()};
  return {point_m(s_m), (end_m - begin_m) / length_m};
}

}  // namespace swarm::agent
