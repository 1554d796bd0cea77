// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "swarm_monitor/audit/tracking/plan_timeline.hpp"

namespace swarm::monitor {

/// CVaR_α of values with equal probability: the mean of the largest share α of them, of which the
/// last one may count in part                                                  [ROVER, eq. 7, 25a]
///
///   CVaR_α = 1/(αn) (Σ_{i ≤ ⌊αn⌋} y₍ᵢ₎ + (αn − ⌊αn⌋) y₍⌊αn⌋₊₁₎),   y₍₁₎ ≥ y₍₂₎ ≥ …
///
/// The largest value for αn ≤ 1. O(n), reorders them. \pre not empty, 0 < α < 1; asserted
double empirical_cvar(std::span<double> values, double alpha);

/// The risk at one moment [m]; a positive value is a depth inside an obstacle.
struct RiskMoment {
  double time_s = 0.0;
  double executed_m = 0.0;  ///< largest over the obstacles
  double planned_m = 0.0;   ///< largest over the obstacles
};

/// CVaR_α(−sd(x, O)) over the living robots' centres, per convex obstacle and moment, beside that
/// of χ(τ) at the same time.
struct ExecutedRisk {
  double worst_m = 0.0;  ///< executed
  double planned_worst_m = 0.0;
  double kept_share = 0.0;  ///< of moments with executed ≤ planner.risk_delta_m at every obstacle
  /// Largest executed minus planned, over obstacles and moments at which either is above −5 m.
  std::optional<double> most_over_plan_m{};
  /// The risk that the safety filter keeps by itself, whatever the plan: −(radius + margin). A
  /// mission's δ above it cannot be missed.
  double filter_m = 0.0;
  std::vector<RiskMoment> moments{};
};

/// Empty without moments or obstacles. O(moments · obstacles · (robots + components)).
std::optional<ExecutedRisk> executed_risk(const RecordedRun& run,
                                          std::span<const PlanMoment> moments);

}  // namespace swarm::monitor
