// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "swarm_monitor/audit/tracking/plan_timeline.hpp"

namespace swarm::monitor {

/// Mean of a plan's mixture at τ [m]. O(legs); no covariances.
Vec2 plan_mean(const FlowPlan& plan, double plan_time_s);

/// Signed lag of the swarm's centre against the plan [s]: the shift L that minimises
///
///   Σ over the moments ‖c(t) − m(τ(t) − L)‖²,   |L| ≤ kMostCentreLag_s
///
/// c is the centre of the living robots and m the mean of the plan in force at t (before the plan's
/// begin its first mean, after its end its last). Late is positive. Resolution 0.05 s. Of equally
/// good shifts the smallest is taken, so that a plan at rest gives 0. Empty without moments. m is
/// read from a table with a spacing of 0.25 s: O(legs · duration + moments · shifts).
std::optional<double> centre_lag_s(const RecordedRun& run, std::span<const PlanMoment> moments);

inline constexpr double kMostCentreLag_s = 60.0;

}  // namespace swarm::monitor
