// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/plan_density.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "planner_service/flow/density_parts.hpp"
#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

// A Gaussian at one time, and which leg it is on.
struct Part : DensityPart {
  std::uint32_t from, to;
};

// The mixture of a plan at one time: waiting sources, legs under way, and sinks that were reached.
class Slice {
 public:
  /// `smoothed_m2` is added to both variances of every Gaussian.
  Slice(const FlowPlan& plan, double robots, MissionTime t, double smoothed_m2 = 0.0)
      : time_(t), smoothed_m2_(smoothed_m2) {
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

  // A local maximum for each mean where the density is large enough to lead to a peak above the
  // density of interest. Several means may lead to the same one.
  std::vector<DensityPeak> peaks(double interest_per_m2) const {
    std::vector<DensityPeak> peaks;
    std::vector<DensityPart> in_sight;
    for (const Part& start : parts_) {
      in_sight.clear();
      double density = 0.0;
      for (const Part& part : parts_) {
        if (!part.is_in_sight(start.mean_m())) continue;
        in_sight.push_back(part);
        density += part.density_at(start.mean_m());
      }
      if (density < kWorthClimbing * interest_per_m2) continue;
      const Vec2 top_m = climb(in_sight, start.mean_m());
      peaks.push_back({density_at(top_m), time_, top_m});
    }
    return peaks;
  }

  // The reported density counts all parts, however far.
  double density_at(const Vec2& x) const {
    double density = 0.0;
    for (const Part& part : parts_) {
      density += part.full_density_at(x);
    }
    return density;
  }

 private:
  void add(const Gaussian& g, double robots, std::uint32_t from, std::uint32_t to) {
    parts_.push_back({DensityPart(g, robots, smoothed_m2_), from, to});
  }

  MissionTime time_{0};
  double smoothed_m2_ = 0.0;
  std::vector<Part> parts_;
};

// Mean density in a disc: Gauss-Legendre in the square of the radius, even steps in the angle.
// Exact to 0.1 % where no Gaussian is narrower than a third of the radius.
double disc_density(const Slice& slice, const Vec2& center_m, double radius_m) {
  constexpr std::array kAreas{0.0694318442029737, 0.3300094782075719, 0.6699905217924281,
                              0.9305681557970263};
  constexpr std::array kWeights{0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                0.1739274225687269};
  constexpr int kAngles = 12;
  double density = 0.0;
  for (std::size_t ring = 0; ring < kAreas.size(); ++ring) {
    const double r_m = radius_m * std::sqrt(kAreas[ring]);
    for (int i = 0; i < kAngles; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAngles;
      density += kWeights[ring] / kAngles *
                 slice.density_at(center_m + r_m * Vec2(std::cos(angle), std::sin(angle)));
    }
  }
  return density;
}

}  // namespace

// The nodes' times are included because the density is not smooth there. Plans may begin before 0.
std::vector<MissionTime> density_times(const FlowPlan& plan, double step_s) {
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

// The highest density so far is the density of interest, so that few climbs remain after the first
// times.
DensityPeak max_density(const FlowPlan& plan, double robots, double step_s) {
  DensityPeak highest;
  for (const MissionTime t : density_times(plan, step_s)) {
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

// The density smoothed by a Gaussian with the disc's covariance approximates the mean over the
// disc, and can be climbed; the disc at each of its peaks is then integrated.
DensityPeak densest_disc(const FlowPlan& plan, double robots, double radius_m, double step_s) {
  SWARM_ASSERT(radius_m > 0.0);
  DensityPeak highest;
  for (const MissionTime t : density_times(plan, step_s)) {
    const Slice slice(plan, robots, t);
    for (DensityPeak peak :
         Slice(plan, robots, t, 0.25 * radius_m * radius_m).peaks(highest.per_m2)) {
      peak.per_m2 = disc_density(slice, peak.at_m, radius_m);
      if (peak.per_m2 > highest.per_m2) highest = peak;
    }
  }
  return highest;
}

DensityPeak densest_disc_of(const FlowPlan& plan, double robots, double scale) {
  constexpr double kStep_s = 2.0;  // a mean moves 2.5 m, about a disc's radius
  return densest_disc(plan, robots, scale * kDisc_m, kStep_s);
}

// Peaks with the legs that cause them, for lowering capacities and undoing moves.
std::vector<SharedPeak> peaks_above(const FlowPlan& plan, double robots, double step_s,
                                    double limit_per_m2) {
  std::vector<SharedPeak> above;
  for (const MissionTime t : density_times(plan, step_s)) {
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
