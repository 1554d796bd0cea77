// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "swarmflow/mission/options.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {

/// Key `criteria`: what the audit demands of a run beyond arrival and no contact. A limit that is
/// not set is not judged; one whose quantity cannot be computed from the run fails the run. The
/// *floor* of a W2 distance is W2 between two random samples of the plan's mixture, with as many
/// points as robots: a swarm that follows the plan perfectly has ratio 1. The quantities and how
/// they are measured: "Tracking and criteria" in docs/audit.md.
struct CriteriaSpec {
  /// A limit; empty: not judged.
  using Bar = std::optional<double>;
  Bar w2_ratio_max{};              ///< mean W2 of swarm and χ(τ), divided by the mean floor
  Bar w2_half_ratio_max{};         ///< the same while at most half of the robots have arrived
  Bar w2_end_ratio_max{};          ///< W2 of last positions and goal mixture, divided by its floor
  Bar centre_lag_max_s{};          ///< absolute value of the lag of the swarm's centre
  Bar lag_p90_max_s{};             ///< 90th percentile of the absolute values of robots' lags
  Bar lag_p99_max_s{};             ///< 99th percentile of these
  Bar clock_error_max_s{};         ///< largest difference of a robot's τ to the published one
  Bar reference_p50_max_m{};       ///< median distance of robots under way to their references
  Bar reference_p95_max_m{};       ///< 95th percentile of these distances
  Bar reference_rms_max_m{};       ///< root mean square of these distances
  Bar density_over_cap_p95_max{};  ///< executed peak / cap − 1, 95th percentile over time
  Bar density_over_cap_max{};      ///< executed peak / cap − 1, largest over time
  Bar planned_over_cap_max{};      ///< planned peak / cap − 1, largest over time
  Bar cvar_kept_share_min{};  ///< share of times with the executed CVaR ≤ planner.risk_delta_m
  Bar own_place_share_min{};  ///< share of robots within 0.7 m of their last reference
  Bar path_ratio_max{};       ///< mean path divided by the geodesic bound
  Bar mission_over_plan_max_s{};  ///< mission time minus the first plan's duration
  Bar arrival_spread_max_s{};     ///< from 5 % to 95 % of the arrival times
};

/// Keys of the section.
inline constexpr auto kCriteriaKeys = std::to_array<SectionKey<CriteriaSpec>>({
    {"w2_ratio_max", &CriteriaSpec::w2_ratio_max, positive(1000),
     "mean W2 of swarm and plan, divided by its mean floor (W2 of two samples of the plan)"},
    {"w2_half_ratio_max", &CriteriaSpec::w2_half_ratio_max, positive(1000),
     "the same while at most half of the robots have arrived"},
    {"w2_end_ratio_max", &CriteriaSpec::w2_end_ratio_max, positive(1000),
     "W2 of the last positions and the goal mixture, divided by its floor"},
    {"centre_lag_max_s", &CriteriaSpec::centre_lag_max_s, positive(3600),
     "absolute value of the lag of the swarm's centre"},
    {"lag_p90_max_s", &CriteriaSpec::lag_p90_max_s, positive(3600),
     "90th percentile of the absolute values of the robots' lags"},
    {"lag_p99_max_s", &CriteriaSpec::lag_p99_max_s, positive(3600),
     "99th percentile of the absolute values of the robots' lags"},
    {"clock_error_max_s", &CriteriaSpec::clock_error_max_s, positive(3600),
     "largest difference of a robot's plan time to the published one"},
    {"reference_p50_max_m", &CriteriaSpec::reference_p50_max_m, positive(1e6),
     "distance of robots under way to their own references, median"},
    {"reference_p95_max_m", &CriteriaSpec::reference_p95_max_m, positive(1e6),
     "the same, 95th percentile"},
    {"reference_rms_max_m", &CriteriaSpec::reference_rms_max_m, positive(1e6),
     "the same, root mean square"},
    {"density_over_cap_p95_max", &CriteriaSpec::density_over_cap_p95_max, between(-1, 1000),
     "executed peak density / cap - 1, 95th percentile over time"},
    {"density_over_cap_max", &CriteriaSpec::density_over_cap_max, between(-1, 1000),
     "the same, largest over time"},
    {"planned_over_cap_max", &CriteriaSpec::planned_over_cap_max, between(-1, 1000),
     "planned peak density / cap - 1, largest over time"},
    {"cvar_kept_share_min", &CriteriaSpec::cvar_kept_share_min, between(0, 1),
     "share of times with the executed CVaR <= planner.risk_delta_m"},
    {"own_place_share_min", &CriteriaSpec::own_place_share_min, between(0, 1),
     "share of robots within 0.7 m of their last reference"},
    {"path_ratio_max", &CriteriaSpec::path_ratio_max, positive(1000),
     "mean path divided by the geodesic bound"},
    {"mission_over_plan_max_s", &CriteriaSpec::mission_over_plan_max_s, between(-1e6, 1e6),
     "mission time minus the first plan's duration"},
    {"arrival_spread_max_s", &CriteriaSpec::arrival_spread_max_s, positive(1e6),
     "time from the 5th to the 95th percentile of the arrivals"},
});

}  // namespace swarm
