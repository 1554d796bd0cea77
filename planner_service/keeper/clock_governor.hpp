// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/plan_clock.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::planner {

/// How far a robot is behind the plan.
struct RobotLag {
  RobotId robot;
  double lag_s = 0.0;  ///< plan time; negative if it is ahead
  bool arrived = false;
};

/// The clock of the plan in force, a reference governor: plan time τ advances with time while the
/// swarm keeps up, slower when it falls behind, so that the mixture waits for the swarm instead of
/// leaving it.
///
///   τ̇ = clamp(1 − (L − L₀)/(L₁ − L₀), rate_min, 1)
///
/// L is a quantile of the robots' lags; arrived robots count as 0, hopeless ones not at all. The
/// least rate keeps a dense region without room from stopping the mission for good: its lag comes
/// from robots spread over space, which waiting does not reduce. While the mission does not run, τ
/// is constant. Keys of the mission: plan_clock. Pure: time and lags in, τ out.
class ClockGovernor {
 public:
  explicit ClockGovernor(const PlanClockSpec& spec) : spec_(spec) {}

  /// A plan is issued: its clock starts at 0.
  void issue(std::uint32_t version, SteadyTime now);

  /// Moves τ on to `now`; `runs`: whether the mission did since the last call.
  void advance(SteadyTime now, bool runs);

  /// The robots are at least at this time of the same plan: a planner that was restarted goes on
  /// from there. τ never goes back.
  void catch_up(double plan_time_s) { plan_time_s_ = std::max(plan_time_s_, plan_time_s); }

  /// Sets the rate from the lags of all robots that reported lately.
  void judge(std::span<const RobotLag> robots);

  double plan_time_s() const { return plan_time_s_; }
  double rate() const { return runs_ ? rate_ : 0.0; }
  PlanClock reading(UtcTime now) const;

  /// Robots that were too late to wait for at the last judge().
  const std::vector<RobotId>& hopeless() const { return hopeless_; }
  double lag_s() const { return lag_s_; }  ///< L of the last judge()

 private:
  PlanClockSpec spec_;
  std::uint32_t version_ = 0;
  double plan_time_s_ = 0.0;
  double rate_ = 1.0;
  bool runs_ = false;
  double lag_s_ = 0.0;
  SteadyTime at_;
  std::vector<RobotId> hopeless_;
  std::vector<double> lags_;
};

}  // namespace swarm::planner
