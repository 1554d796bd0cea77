// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/plan_timeline.hpp"

#include <algorithm>

namespace swarm::monitor {

PlanTimeline::PlanTimeline(const RecordedRun& run)
    : plans_(run.plans), clock_(run.clock), begin_(run.begin) {}

/// Binary search in the clock's records, then in the plans by version. Plan time before the plan's
/// begin counts as 0.
std::optional<PlanMoment> PlanTimeline::at(double time_s) const {
  const UtcTime now = begin_ + from_seconds(time_s);
  const PlanClock* const clock = clock_at(clock_, now);
  if (clock == nullptr) return std::nullopt;
  const auto published = std::lower_bound(
      plans_.begin(), plans_.end(), clock->plan_version,
      [](const PublishedPlan& plan, std::uint32_t version) { return plan.version < version; });
  if (published == plans_.end() || published->version != clock->plan_version) return std::nullopt;
  return PlanMoment{.published = &*published,
                    .time_s = time_s,
                    .plan_time_s = std::max(0.0, clock->plan_time_at_s(now))};
}

/// Multiples of the step, not a running sum: rounding errors do not accumulate over long runs.
std::vector<PlanMoment> PlanTimeline::moments(double begin_s, double end_s, double step_s) const {
  std::vector<PlanMoment> moments;
  for (std::size_t k = 0;; ++k) {
    const double time_s = begin_s + static_cast<double>(k) * step_s;
    if (!(time_s <= end_s)) return moments;
    const auto moment = at(time_s);
    if (moment && moment->plan_time_s <= moment->published->plan.duration().count()) {
      moments.push_back(*moment);
    }
  }
}

/// Integer arithmetic picks the last moment of each of `most` equal parts, so the very last one is
/// always kept.
std::vector<PlanMoment> thinned(std::span<const PlanMoment> moments, std::size_t most) {
  if (moments.size() <= most) return {moments.begin(), moments.end()};
  std::vector<PlanMoment> kept;
  for (std::size_t k = 1; k <= most; ++k) kept.push_back(moments[k * moments.size() / most - 1]);
  return kept;
}

}  // namespace swarm::monitor
