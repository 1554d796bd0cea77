// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "swarmflow/mission/options.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {

/// Key `plan_clock`: how far the plan's clock τ slows down when the swarm falls behind the plan.
struct PlanClockSpec {
  double lag_quantile = 0.75;    ///< quantile L of the robots' lags that sets the rate
  double lag_free_s = 2.0;       ///< L₀: up to this lag τ advances with time
  double lag_stop_s = 8.0;       ///< L₁: lag at which the rate would be 0 without rate_min
  double rate_min = 0.2;         ///< least dτ/dt; 1: the clock never slows down
  double hopeless_lag_s = 30.0;  ///< robots later than this do not count; they are reported
};

/// Keys of the section.
inline constexpr auto kPlanClockKeys = std::to_array<SectionKey<PlanClockSpec>>({
    {"lag_quantile", &PlanClockSpec::lag_quantile, between(0.5, 1),
     "quantile of the robots' lags that slows the plan's clock"},
    {"lag_free_s", &PlanClockSpec::lag_free_s, between(0, 3600),
     "up to this lag the plan's clock runs at full rate"},
    {"lag_stop_s", &PlanClockSpec::lag_stop_s, positive(3600),
     "at this lag its rate would reach 0; rate_min bounds it"},
    {"rate_min", &PlanClockSpec::rate_min, between(0.01, 1),
     "smallest rate of the plan's clock; 1: it never slows down"},
    {"hopeless_lag_s", &PlanClockSpec::hopeless_lag_s, positive(1e6),
     "robots that lag more are reported and do not slow the clock"},
});

}  // namespace swarm
