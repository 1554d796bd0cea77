// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/keeper/clock_governor.hpp"

#include <algorithm>
#include <cmath>

namespace swarm::planner {

void ClockGovernor::issue(std::uint32_t version, SteadyTime now) {
  version_ = version;
  plan_time_s_ = 0.0;
  at_ = now;
}

void ClockGovernor::advance(SteadyTime now, bool runs) {
  // The clock advances only if the mission ran at both calls: one that was just started or resumed
  // has no time behind it yet.
  if (runs && runs_ && now > at_) plan_time_s_ += rate_ * to_seconds(now - at_);
  runs_ = runs;
  at_ = std::max(at_, now);
}

// The rate from the quantile of the lags, by linear interpolation between lag_free_s (full rate)
// and lag_stop_s. If all robots are hopeless, none remains to judge by, and the least rate applies.
void ClockGovernor::judge(std::span<const RobotLag> robots) {
  lags_.clear();
  hopeless_.clear();
  for (const RobotLag& robot : robots) {
    if (!robot.arrived && robot.lag_s > spec_.hopeless_lag_s) {
      hopeless_.push_back(robot.robot);
    } else {
      lags_.push_back(robot.arrived ? 0.0 : robot.lag_s);
    }
  }
  if (lags_.empty()) {
    lag_s_ = 0.0;
    rate_ = hopeless_.empty() ? 1.0 : spec_.rate_min;
    return;
  }
  const auto rank =
      static_cast<std::size_t>(std::ceil(spec_.lag_quantile * static_cast<double>(lags_.size())));
  const auto at = lags_.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(lags_.begin(), at, lags_.end());
  lag_s_ = *at;
  rate_ = std::clamp(1.0 - (lag_s_ - spec_.lag_free_s) / (spec_.lag_stop_s - spec_.lag_free_s),
                     spec_.rate_min, 1.0);
}

PlanClock ClockGovernor::reading(UtcTime now) const {
  return {.stamp = now, .plan_version = version_, .plan_time_s = plan_time_s_, .rate = rate()};
}

}  // namespace swarm::planner
