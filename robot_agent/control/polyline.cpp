// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/control/polyline.hpp"

#include <algorithm>

#include "swarm_core/base/assert.hpp"

namespace swarm::agent {

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

std::size_t Polyline::segment_of(double s_m, std::size_t near) const {
  std::size_t i = std::min(near, arc_.size() - 2);
  while (i + 2 < arc_.size() && arc_[i + 1] <= s_m) ++i;
  while (i > 0 && arc_[i] > s_m) --i;
  return i;
}

Polyline::Place Polyline::place(double s_m, std::size_t near) const {
  if (vertices_.size() == 1) return {vertices_.front(), Vec2::Zero(), 0};
  const double s = std::clamp(s_m, 0.0, length_m());
  const std::size_t i = segment_of(s, near);
  const double piece_m = arc_[i + 1] - arc_[i];
  const double t = (s - arc_[i]) / piece_m;
  return {(1.0 - t) * vertices_[i] + t * vertices_[i + 1],
          (vertices_[i + 1] - vertices_[i]) / piece_m, i};
}

}  // namespace swarm::agent
