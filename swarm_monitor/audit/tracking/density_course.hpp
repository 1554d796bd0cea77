// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "swarm_monitor/audit/tracking/disc_density.hpp"
#include "swarm_monitor/audit/tracking/plan_timeline.hpp"

namespace swarm::monitor {

/// Flown and planned peak density at one moment.
struct DensityMoment {
  double time_s = 0.0;
  double flown_per_m2 = 0.0;    ///< most living robots in any disc over its area
  double planned_per_m2 = 0.0;  ///< of χ(τ) for all robots, mean over the densest disc
};

/// Peaks over a run.
struct DensityCourse {
  double worst_per_m2 = 0.0;  ///< flown
  double p95_per_m2 = 0.0;    ///< flown, at 95 % of moments no more
  double planned_worst_per_m2 = 0.0;
  std::optional<double> cap_per_m2{};   ///< of the mission
  std::optional<double> dense_share{};  ///< of moments with flown > cap + 20 %
  std::vector<DensityMoment> moments{};

  /// (peak − cap)/cap; empty without a cap.
  std::optional<double> over_cap(double peak_per_m2) const;
};

/// The cap on the density of χ(t) that the planning method of a run held its plans to, as it
/// recorded it; of a run without that record the cap in the mission file. Empty if there is none.
std::optional<double> density_cap_of(const RecordedRun& run);

/// Empty without moments. 1 to 3 ms a moment for 500 robots and 300 legs.
std::optional<DensityCourse> density_course(const RecordedRun& run,
                                            std::span<const PlanMoment> moments);

}  // namespace swarm::monitor
