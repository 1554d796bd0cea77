// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/transport/plan_density.hpp"

#include <algorithm>
#include <cmath>

#include "planner_service/transport/density_cap.hpp"
#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

constexpr int kClimbSteps = 40;
constexpr double kClimbed_m = 1e-3;
// A Gaussian adds less than 1e-6 of its peak beyond this many standard deviations, ...
constexpr double kFar = 5.3;
constexpr double kFarSquared = kFar * kFar;
// ... and is left out of a climb that starts two more away: one of the parts in between would have
// to pull it that far.
constexpr double kOutOfSight = kFar + 2.0;
// Means where the density is this far below what is of interest are not climbed from. The middle of
// a square of equal Gaussians has 1.3 times the density of its corners at most.
constexpr double kWorthClimbing = 0.7;

// A Gaussian at one time, ready to be evaluated.
struct Part {
  Vec2 mean_m;
  Vec2 sight_m;       // half the box beyond which it is out of sight
  double xx, xy, yy;  // Σ⁻¹
  double peak_per_m2;
  std::uint32_t from, to;

  bool is_in_sight(const Vec2& x) const {
    return std::abs(x.x() - mean_m.x()) <= sight_m.x() &&
           std::abs(x.y() - mean_m.y()) <= sight_m.y();
  }
  double mahalanobis_squared(const Vec2& x) const {
    const Vec2 d = x - mean_m;
    return xx * d.x() * d.x() + 2.0 * xy * d.x() * d.y() + yy * d.y() * d.y();
  }
  double density_at(const Vec2& x) const {
    const double squared = mahalanobis_squared(x);
    return squared > kFarSquared ? 0.0 : peak_per_m2 * std::exp(-0.5 * squared);
  }
};

// Follows the mean shift, which never descends, to a local maximum.
Vec2 climb(const std::vector<Part>& parts, Vec2 x) {
  for (int step = 0; step < kClimbSteps; ++step) {
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    Vec2 pull = Vec2::Zero();
    for (const Part& part : parts) {
      const double w = part.density_at(x);
      if (w == 0.0) continue;
      xx += w * part.xx;
      xy += w * part.xy;
      yy += w * part.yy;
      pull.x() += w * (part.xx * part.mean_m.x() + part.xy * part.mean_m.y());
      pull.y() += w * (part.xy * part.mean_m.x() + part.yy * part.mean_m.y());
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

class Slice {
 public:
  Slice(const FlowPlan& plan, double robots, MissionTime t) : time_(t) {
    const auto& nodes = plan.nodes();
    for (const std::uint32_t i : plan.sources()) {
      if (t < nodes[i].time) add(nodes[i].gaussian, nodes[i].mass * robots, i, i);
    }
    for (const PlanLeg& leg : plan.legs()) {
      const PlanNode& from = nodes[leg.from];
      const PlanNode& to = nodes[leg.to];
      if (t < from.time || t >= to.time) continue;
      const double share = (t - from.time) / (to.time - from.time);
      add(Geodesic(from.gaussian, to.gaussian).at(share), leg.mass * robots, leg.from, leg.to);
    }
    for (const std::uint32_t i : plan.sinks()) {
      if (t >= nodes[i].time) add(nodes[i].gaussian, nodes[i].mass * robots, i, i);
    }
  }

  Slice(std::span<const Gaussian> components, std::span<const double> masses, double robots) {
    for (std::uint32_t i = 0; i < masses.size(); ++i) add(components[i], masses[i] * robots, i, i);
  }

  const std::vector<Part>& parts() const { return parts_; }

  // One peak for each mean worth climbing from, given what is of interest.
  std::vector<DensityPeak> peaks(double interest_per_m2) const {
    std::vector<DensityPeak> peaks;
    std::vector<Part> in_sight;
    for (const Part& start : parts_) {
      in_sight.clear();
      double density = 0.0;
      for (const Part& part : parts_) {
        if (!part.is_in_sight(start.mean_m)) continue;
        in_sight.push_back(part);
        density += part.density_at(start.mean_m);
      }
      if (density < kWorthClimbing * interest_per_m2) continue;
      const Vec2 top_m = climb(in_sight, start.mean_m);
      peaks.push_back({density_at(top_m), time_, top_m});
    }
    return peaks;
  }

  // Nothing is too far for the result.
  double density_at(const Vec2& x) const {
    double density = 0.0;
    for (const Part& part : parts_) {
      density += part.peak_per_m2 * std::exp(-0.5 * part.mahalanobis_squared(x));
    }
    return density;
  }

 private:
  void add(const Gaussian& g, double robots, std::uint32_t from, std::uint32_t to) {
    const Mat2& s = g.covariance_m2();
    const double det = g.determinant();
    const Vec2 sight_m(kOutOfSight * std::sqrt(s(0, 0)), kOutOfSight * std::sqrt(s(1, 1)));
    parts_.push_back({g.mean_m(), sight_m, s(1, 1) / det, -s(0, 1) / det, s(0, 0) / det,
                      peak_density_per_m2(g, robots, 1.0), from, to});
  }

  MissionTime time_{0};
  std::vector<Part> parts_;
};

std::vector<MissionTime> sample_times(const FlowPlan& plan, double step_s) {
  SWARM_ASSERT(step_s > 0.0);
  std::vector<MissionTime> times;
  double first_s = 0.0;
  for (const PlanNode& node : plan.nodes()) {
    times.push_back(node.time);
    first_s = std::min(first_s, node.time.count());
  }
  const auto steps = static_cast<std::size_t>((plan.duration().count() - first_s) / step_s);
  for (std::size_t i = 0; i <= steps; ++i) {
    times.emplace_back(first_s + static_cast<double>(i) * step_s);
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}  // namespace

DensityPeak max_density(const FlowPlan& plan, double robots, double step_s) {
  DensityPeak highest;
  for (const MissionTime t : sample_times(plan, step_s)) {
    for (const DensityPeak& peak : Slice(plan, robots, t).peaks(highest.per_m2)) {
      if (peak.per_m2 > highest.per_m2) highest = peak;
    }
  }
  return highest;
}

DensityPeak max_density(std::span<const Gaussian> components, std::span<const double> masses,
                        double robots) {
  DensityPeak highest;
  for (const DensityPeak& peak : Slice(components, masses, robots).peaks(0.0)) {
    if (peak.per_m2 > highest.per_m2) highest = peak;
  }
  return highest;
}

std::vector<SharedPeak> peaks_above(const FlowPlan& plan, double robots, double step_s,
                                    double limit_per_m2) {
  std::vector<SharedPeak> above;
  for (const MissionTime t : sample_times(plan, step_s)) {
    const Slice slice(plan, robots, t);
    for (const DensityPeak& peak : slice.peaks(limit_per_m2)) {
      if (peak.per_m2 <= limit_per_m2) continue;
      SharedPeak shared{peak, {}};
      for (const Part& part : slice.parts()) {
        const double density = part.density_at(peak.at_m);
        if (density > 0.0) shared.shares.push_back({part.from, part.to, density});
      }
      above.push_back(std::move(shared));
    }
  }
  return above;
}

}  // namespace swarm::planner
