// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/tracking.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "swarm_monitor/audit/tracking/swarm_walk.hpp"

namespace swarm::monitor {
namespace {

/// Number of moments that are measured however large the swarm is.
constexpr std::size_t kFewestMoments = 20;
/// Number of steps of a run at most: a damaged stamp far in the future must not take hours.
constexpr double kMostSteps = 20'000.0;

/// Share of the motion that the published clock covers, and its rate. Sampled every `step_s` over
/// the motion.
std::optional<ClockUse> clock_use(const RecordedRun& run, const PlanTimeline& timeline,
                                  const MotionSpan& motion, double step_s) {
  if (run.clock.empty()) return std::nullopt;
  ClockUse use{.rate_min = 1.0};
  std::size_t all = 0, covered = 0, slowed = 0;
  for (double time_s = motion.begin_s; time_s <= motion.end_s; time_s += step_s) {
    ++all;
    if (!timeline.at(time_s)) continue;
    const double rate = clock_at(run.clock, run.begin + from_seconds(time_s))->rate;
    ++covered;
    slowed += rate < 1.0 ? 1 : 0;
    use.rate_mean += rate;
    use.rate_min = std::min(use.rate_min, rate);
  }
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  use.covered_share = share(covered, all);
  use.slowed_share = share(slowed, covered);
  if (covered > 0) use.rate_mean /= static_cast<double>(covered);
  return use;
}

}  // namespace

/// An empty text means that the clock is usable. The checks are ordered from the most to the least
/// fundamental.
std::string Tracking::no_clock() const {
  if (!clock) return "no plan clock was published";
  if (clock->covered_share < kLeastCovered) {
    return fmt::format("the published clock names a recorded plan for {:.0f} % of the motion",
                       100.0 * clock->covered_share);
  }
  if (distances.empty()) return "no robot lived while a plan was in force";
  return {};
}

/// References are taken from the robots' own logs, so they are checked against the plan before
/// anything is judged by them: complete enough, and distributed like the plan's mixture.
std::string Tracking::no_references() const {
  if (std::string why = no_clock(); !why.empty()) return why;
  if (own.followed_share < kLeastFollowed) {
    return fmt::format("robots under way followed the plan in time for {:.0f} % of it",
                       100.0 * own.followed_share);
  }
  if (!references) return "the logged references were never complete";
  if (references->ratio() > kTruthfulRatio) {
    return fmt::format("the logged references are not those of the plan: W2 {:.2f} m, floor {:.2f}",
                       references->w2_m, references->floor_m);
  }
  return {};
}

/// The ends are measured for every run; everything else needs motion and a clock. The effort is
/// bounded by thinning the moments, separately for each measure, since an assignment costs far more
/// than a lag.
Tracking measure_tracking(const RecordedRun& run, const TrackingEffort& effort) {
  Tracking tracking;
  tracking.ending = ending_of(run);
  if (const FlowPlan* plan = run.first_plan()) tracking.plan_s = plan->duration().count();
  const auto motion = motion_of(run.tracks);
  if (!motion) return tracking;
  const PlanTimeline timeline(run);
  const double step_s = std::max(effort.step_s, (motion->end_s - motion->begin_s) / kMostSteps);
  tracking.clock = clock_use(run, timeline, *motion, step_s);
  if (!tracking.clock) return tracking;
  const std::vector<PlanMoment> all = timeline.moments(motion->begin_s, motion->end_s, step_s);
  // Moments per robot shrink with the size of the swarm, so that robots · moments stay within the
  // effort.
  const std::size_t fine = std::max(
      kFewestMoments, effort.most_robot_moments / std::max<std::size_t>(1, run.tracks.size()));
  const std::vector<PlanMoment> moments = thinned(all, fine);
  tracking.distances = swarm_distances(run, thinned(all, effort.most_distances));
  tracking.w2 = mean_distance(tracking.distances);
  tracking.references = mean_reference_distance(tracking.distances);
  tracking.plans = distances_by_plan(tracking.distances);
  std::vector<SwarmDistance> half = tracking.distances;
  std::erase_if(half, [](const SwarmDistance& d) { return d.arrived_share > 0.5; });
  tracking.w2_half = mean_distance(half);
  tracking.centre_lag_s = centre_lag_s(run, moments);
  tracking.own = own_reference(run, moments);
  tracking.density = density_course(run, moments);
  tracking.risk = executed_risk(run, thinned(all, effort.most_risks));
  return tracking;
}

}  // namespace swarm::monitor
