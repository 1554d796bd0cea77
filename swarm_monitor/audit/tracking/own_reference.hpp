// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "swarm_monitor/audit/tracking/plan_timeline.hpp"

namespace swarm::monitor {

/// Quantiles of the robots' lags over (robot, moment) [s]; late is positive. `late_` and amounts
/// are over all living robots that follow the plan in force, arrived ones included.
struct LagQuantiles {
  double p1_s = 0.0, p10_s = 0.0, p50_s = 0.0, p90_s = 0.0, p99_s = 0.0;
  double amount_p90_s = 0.0, amount_p99_s = 0.0;  ///< of |lag|: early counts as late does
};

/// Distances of robots to their own references over (robot, moment) while they are under way [m].
struct ReferenceError {
  double p50_m = 0.0, p95_m = 0.0, rms_m = 0.0;
};

/// The lags at one moment.
struct LagMoment {
  double time_s = 0.0;
  double p10_s = 0.0, p50_s = 0.0, p90_s = 0.0;
};

/// The robots against their own logged references.
struct OwnReference {
  std::optional<LagQuantiles> lag{};
  std::optional<ReferenceError> error{};
  /// Share of (robot under way, moment) at which the robot followed the plan in force in time.
  double followed_share = 0.0;
  /// Largest difference between a robot's τ and the published one at the same time [s].
  std::optional<double> clock_error_s{};
  std::vector<LagMoment> moments{};
};

/// Compares positions with the reference curves that the robots themselves logged, at the
/// *published* τ: a robot that follows a clock of its own counts as late. Whether the curves are
/// those of the plan is another check: swarm_distances(). Moments ascend in time. O(robots ·
/// moments · entries of a curve within the window): 1.3 s for 500 robots and 269 moments.
/// With a new plan every second, each plan begins where its robots are: lags and distances then
/// stay small whatever the robots do, and only the duration and the CVaR can still fail.
OwnReference own_reference(const RecordedRun& run, std::span<const PlanMoment> moments);

}  // namespace swarm::monitor
