// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/shared/virtual_diffusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "robot_agent/methods/shared/shape_attraction.hpp"

namespace swarm::agent {
namespace {

constexpr std::size_t kSteps = 128;
// The last 24 steps have no noise, so that the path ends near a minimum.
constexpr std::size_t kNoisySteps = 104;

// Reflects x at low and high until it is within; the midpoint if the interval is empty.
double mirrored(double x, double low, double high) {
  if (!(low < high)) return 0.5 * (low + high);
  const double period = 2.0 * (high - low);
  double y = std::fmod(x - low, period);
  if (y < 0.0) y += period;
  return low + std::min(y, period - y);
}

Vec2 mirrored(const Vec2& x, const Box& bounds, double margin_m) {
  return {mirrored(x.x(), bounds.min_m.x() + margin_m, bounds.max_m.x() - margin_m),
          mirrored(x.y(), bounds.min_m.y() + margin_m, bounds.max_m.y() - margin_m)};
}

// −h∇(F + G) with h at most 1/L (Th. 6.3): explicit steps of this length do not overshoot.
Vec2 drift_m(const Vec2& x, const DiffusionPotential& p, double step_s) {
  Potential v = cotangent_repulsion(x, p.neighbours, p.repulsion);
  if (p.shape != nullptr) v += shape_attraction(x, *p.shape);
  if (!(v.curvature > 0.0)) return -step_s * v.gradient_m;
  return -std::min(step_s, 1.0 / v.curvature) * v.gradient_m;
}

}  // namespace

Vec2 virtual_diffusion(const Vec2& from_m, const DiffusionPotential& potential, const World& world,
                       bool in_sight, const DiffusionOptions& options, Rng& rng) {
  const Vec2 sigma = options.noise_mps05 * Vec2(uniform01(rng), uniform01(rng));
  const double step_s = options.time_s * uniform01(rng) / static_cast<double>(kNoisySteps);
  const Vec2 spread_m = std::sqrt(step_s) * sigma;
  // On the stack: the control loop does not allocate.
  std::array<Vec2, kSteps> path_m;
  Vec2 x = from_m;
  for (std::size_t i = 0; i < kSteps; ++i) {
    Vec2 next = x + drift_m(x, potential, step_s);
    if (i < kNoisySteps) {
      next += spread_m.cwiseProduct(Vec2(standard_normal(rng), standard_normal(rng)));
    }
    next = mirrored(next, world.bounds_m(), options.clearance_m);
    if (world.segment_is_free(x, next, options.clearance_m)) x = next;
    path_m[i] = x;
  }
  if (!in_sight) return x;
  // Backwards from the end: the last position in line of sight.
  const auto last = std::find_if(path_m.rbegin(), path_m.rend(), [&](const Vec2& p) {
    return world.segment_is_free(from_m, p, options.clearance_m);
  });
  return last == path_m.rend() ? from_m : *last;
}

}  // namespace swarm::agent
