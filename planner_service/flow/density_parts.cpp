// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/density_parts.hpp"

namespace swarm::planner {
namespace {

constexpr int kClimbSteps = 40;
constexpr double kClimbed_m = 1e-3;
// A part is left out of a climb that starts this much farther away than it reaches: one of the
// parts in between would have to pull it that far.
constexpr double kPulledSigmas = 2.0;

}  // namespace

// Stores the inverse covariance and the peak, so that evaluating costs one exponential.
DensityPart::DensityPart(const Gaussian& g, double robots, double smoothed_m2)
    : mean_m_(g.mean_m()) {
  const Mat2 s = g.covariance_m2() + smoothed_m2 * Mat2::Identity();
  const double det = s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0);
  constexpr double kSight = kFar + kPulledSigmas;
  sight_m_ = {kSight * std::sqrt(s(0, 0)), kSight * std::sqrt(s(1, 1))};
  xx_ = s(1, 1) / det;
  xy_ = -s(0, 1) / det;
  yy_ = s(0, 0) / det;
  peak_per_m2_ = robots / (2.0 * std::numbers::pi * std::sqrt(det));
}

// The mean shift is the fixed-point iteration for ∇density = 0. It ends when a step is shorter than
// kClimbed_m; the position is then exact enough for the density, which is flat at the top.
Vec2 climb(const std::vector<DensityPart>& parts, Vec2 x) {
  for (int step = 0; step < kClimbSteps; ++step) {
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    Vec2 pull = Vec2::Zero();
    for (const DensityPart& part : parts) {
      const double w = part.density_at(x);
      if (w == 0.0) continue;
      xx += w * part.xx_;
      xy += w * part.xy_;
      yy += w * part.yy_;
      pull.x() += w * (part.xx_ * part.mean_m_.x() + part.xy_ * part.mean_m_.y());
      pull.y() += w * (part.xy_ * part.mean_m_.x() + part.yy_ * part.mean_m_.y());
    }
    const double det = xx * yy - xy * xy;
    if (!(det > 0.0)) break;
    const Vec2 next((yy * pull.x() - xy * pull.y()) / det, (xx * pull.y() - xy * pull.x()) / det);
    const bool arrived = (next - x).squaredNorm() < kClimbed_m * kClimbed_m;
    x = next;
    if (arrived) break;
  }
  return x;
}

}  // namespace swarm::planner
