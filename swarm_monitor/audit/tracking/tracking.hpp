// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "swarm_monitor/audit/tracking/centre_lag.hpp"
#include "swarm_monitor/audit/tracking/density_course.hpp"
#include "swarm_monitor/audit/tracking/ending.hpp"
#include "swarm_monitor/audit/tracking/executed_risk.hpp"
#include "swarm_monitor/audit/tracking/own_reference.hpp"
#include "swarm_monitor/audit/tracking/swarm_distance.hpp"

namespace swarm::monitor {

/// The published plan clock during the motion.
struct ClockUse {
  double covered_share = 0.0;  ///< of the motion's seconds, with a recorded plan in force
  double rate_mean = 0.0;      ///< over those seconds
  double rate_min = 0.0;
  double slowed_share = 0.0;  ///< of those seconds, at a rate below 1
};

/// How the swarm followed what was published, from robot logs, plans and the plan's clock alone.
/// What could not be measured is empty. All of it is measured from the first motion on, while the
/// plan in force still moves.
struct Tracking {
  /// With less of the motion covered by the clock, nothing that needs the clock is judged.
  static constexpr double kLeastCovered = 0.9;
  /// Robots that log references must have logged them for this share of their motion.
  static constexpr double kLeastFollowed = 0.9;
  /// W2 of the logged references to the plan must be at most this times its floor.
  static constexpr double kTruthfulRatio = 1.5;

  std::optional<ClockUse> clock{};
  std::vector<SwarmDistance> distances{};
  std::optional<Distance> w2{};       ///< means over all moments
  std::optional<Distance> w2_half{};  ///< means over moments at which at most half had arrived
  std::optional<Distance> references{};
  std::vector<PlanDistance> plans{};
  std::optional<double> centre_lag_s{};
  OwnReference own{};
  std::optional<DensityCourse> density{};
  std::optional<ExecutedRisk> risk{};
  Ending ending{};
  std::optional<double> plan_s{};               ///< duration of the first plan
  std::optional<double> mission_over_plan_s{};  ///< mission time minus that
  std::optional<double> arrival_spread_s{};     ///< 5 % to 95 % of arrival times

  /// Why what needs the published clock is not measured; empty if it is.
  std::string no_clock() const;
  /// Why the robots' references are no evidence; empty if they are.
  std::string no_references() const;
};

/// Limits on the cost of measuring. The defaults give a verdict within seconds: 500 robots over 270
/// s take 3.8 s of a busy core, of which 1.4 s for 40 moments of assignments, 1.3 s for lags, 0.7 s
/// for densities, 0.3 s for the ends.
struct TrackingEffort {
  double step_s = 1.0;
  std::size_t most_distances = 40;
  std::size_t most_risks = 120;
  std::size_t most_robot_moments = 150'000;  ///< for lags and densities
};

/// All but mission_over_plan_s and arrival_spread_s, which need the audit's arrivals.
Tracking measure_tracking(const RecordedRun& run, const TrackingEffort& effort = {});

}  // namespace swarm::monitor
