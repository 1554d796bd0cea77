// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "swarmflow/core/polygon.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::test {

/// A random polygon whose corners are all visible from `center_m`, so it is simple; almost never
/// convex. Radii 1–10 m.
inline std::vector<Vec2> random_star(Rng& rng, const Vec2& center_m, std::size_t corners) {
  std::vector<Vec2> vertices;
  for (std::size_t i = 0; i < corners; ++i) {
    // One corner in each sector keeps every gap below π, so that the center stays inside.
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.8 * uniform01(rng)) /
                         static_cast<double>(corners);
    const double radius = uniform(rng, 1.0, 10.0);
    vertices.emplace_back(center_m + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return vertices;
}

/// Corners on an ellipse, so convex.
inline std::vector<Vec2> random_convex(Rng& rng, const Vec2& center_m, std::size_t corners) {
  const Vec2 axes(uniform(rng, 2.0, 10.0), uniform(rng, 2.0, 10.0));
  std::vector<Vec2> vertices;
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.8 * uniform01(rng)) /
                         static_cast<double>(corners);
    vertices.emplace_back(center_m + axes.cwiseProduct(Vec2(std::cos(angle), std::sin(angle))));
  }
  return vertices;
}

/// A comb with `teeth` teeth: many reflex corners, right angles, collinear tips and gaps.
inline std::vector<Vec2> comb(std::size_t teeth) {
  std::vector<Vec2> vertices{{0, 0}, {2.0 * static_cast<double>(teeth) - 1.0, 0}};
  for (std::size_t i = teeth; i-- > 0;) {
    const double x = 2.0 * static_cast<double>(i);
    vertices.emplace_back(x + 1.0, 5.0);
    vertices.emplace_back(x, 5.0);
    if (i > 0) {
      vertices.emplace_back(x, 1.0);
      vertices.emplace_back(x - 1.0, 1.0);
    }
  }
  return vertices;
}

/// A thin band along a saw-tooth line with `teeth` teeth: ears at its two ends alone.
inline std::vector<Vec2> zigzag(std::size_t teeth) {
  constexpr double kWidth_m = 0.01;
  std::vector<Vec2> vertices;
  for (std::size_t i = 0; i <= teeth; ++i) {
    vertices.emplace_back(static_cast<double>(i), i % 2 == 0 ? 0.0 : 5.0);
  }
  for (std::size_t i = teeth + 1; i-- > 0;) {
    vertices.emplace_back(vertices[i] + Vec2(0.0, kWidth_m));
  }
  return vertices;
}

/// Winding number by the sum of angles: an oracle that shares nothing with parity of crossings.
inline bool winds_around(const std::vector<Vec2>& vertices, const Vec2& p) {
  double angle = 0.0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec2 a = vertices[i] - p;
    const Vec2 b = vertices[(i + 1) % vertices.size()] - p;
    angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return std::abs(angle) > std::numbers::pi;
}

}  // namespace swarm::test
