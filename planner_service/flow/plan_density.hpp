// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/planning/density_peak.hpp"

namespace swarm::planner {

/// A contribution to a peak: the density of one leg, or of one source or sink at rest (`from` =
/// `to`).
struct DensityShare {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  double per_m2 = 0.0;
};

/// A peak of the density with the legs that contribute to it.
struct SharedPeak {
  DensityPeak peak;
  std::vector<DensityShare> shares;
};

/// The times at which densities of a plan are evaluated: `step_s` apart, and those of all nodes.
std::vector<MissionTime> density_times(const FlowPlan& plan, double step_s);

/// The highest density of a plan over sampled times. It depends on the flow alone, not on a solver.
///
/// Times are `step_s` apart, and those of all nodes. At each, the climb starts at the mean of every
/// Gaussian and follows the mean shift x ← (Σ wₖΣₖ⁻¹)⁻¹ Σ wₖΣₖ⁻¹μₖ, wₖ the density of part k at x,
/// which never descends. Cost: times · parts · (parts + those in sight · a dozen steps).
DensityPeak max_density(const FlowPlan& plan, double robots, double step_s);

/// The highest density of Gaussians at rest, found by the same search.
DensityPeak max_density(std::span<const Gaussian> components, std::span<const double> masses,
                        double robots);

/// The most robots in a disc of `radius_m` divided by its area, over sampled times: the space that
/// bodies have. max_density() instead grows without bound where a Gaussian is narrower than a
/// robot.
///
/// Climbs as max_density() does, on the density smoothed by the disc's own covariance (R²/4 I), and
/// counts there, so that it may miss the densest disc by a few per cent, always from below.
DensityPeak densest_disc(const FlowPlan& plan, double robots, double radius_m, double step_s);

/// Radius of the discs in which densities are compared with what fits [m]: ten robots of the
/// default body or more.
inline constexpr double kDisc_m = 2.0;

/// The densest disc of `scale` times kDisc_m of a plan, searched at every 2 s of it.
DensityPeak densest_disc_of(const FlowPlan& plan, double robots, double scale = 1.0);

/// All peaks above `limit_per_m2`, in order of time.
std::vector<SharedPeak> peaks_above(const FlowPlan& plan, double robots, double step_s,
                                    double limit_per_m2);

}  // namespace swarm::planner
