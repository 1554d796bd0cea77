// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "swarm_monitor/audit/recorded_run.hpp"

namespace swarm::monitor {

/// The plan in force at a moment of a run, and its plan time τ.
struct PlanMoment {
  const PublishedPlan* published = nullptr;
  double time_s = 0.0;       ///< since RecordedRun::begin
  double plan_time_s = 0.0;  ///< τ ≥ 0

  /// The planned mixture χ(τ) at this moment.
  Mixture mixture() const { return published->plan.mixture_at(MissionTime(plan_time_s)); }
};

/// Which plan is in force at a time, by the published clock alone. A pure function of plans and
/// clock; both must outlive it.
class PlanTimeline {
 public:
  explicit PlanTimeline(const RecordedRun& run);

  /// O(log readings). Empty before the first reading, and while the plan that the clock names was
  /// not recorded.
  std::optional<PlanMoment> at(double time_s) const;

  /// The moments begin_s, begin_s + step_s, … up to end_s at which the plan in force still moves:
  /// its τ is at most its duration.
  std::vector<PlanMoment> moments(double begin_s, double end_s, double step_s) const;

 private:
  std::span<const PublishedPlan> plans_;
  std::span<const PlanClock> clock_;
  UtcTime begin_;
};

/// At most `most` of the moments, evenly spread over all of them, with the last one.
std::vector<PlanMoment> thinned(std::span<const PlanMoment> moments, std::size_t most);

}  // namespace swarm::monitor
