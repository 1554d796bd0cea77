// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/density_course.hpp"

#include <algorithm>

#include "swarm_monitor/audit/quantile.hpp"
#include "swarm_monitor/audit/tracking/swarm_walk.hpp"

namespace swarm::monitor {
namespace {

constexpr double kDense = 1.2;  // times the cap: denser moments enter dense_share

}  // namespace

/// Relative excess over the cap: 0 at the cap, −1 for an empty disc.
std::optional<double> DensityCourse::over_cap(double peak_per_m2) const {
  if (!cap_per_m2) return std::nullopt;
  return peak_per_m2 / *cap_per_m2 - 1.0;
}

/// The method's own record has precedence: a method may hold its plans to another cap than the
/// mission file asks for, or to none.
std::optional<double> density_cap_of(const RecordedRun& run) {
  if (run.planning) return run.planning->density_cap_per_m2;
  const std::optional<double>& asked_for = run.mission.planner.density_cap_per_m2;
  return asked_for && *asked_for > 0.0 ? asked_for : std::nullopt;
}

/// Flown and planned peaks at the same moments, so that they can be compared. Both use discs of
/// kDiscRadius_m.
std::optional<DensityCourse> density_course(const RecordedRun& run,
                                            std::span<const PlanMoment> moments) {
  DensityCourse course{.cap_per_m2 = density_cap_of(run)};
  std::vector<double> peaks;
  SwarmWalk walk(run.tracks);
  for (const PlanMoment& moment : moments) {
    std::vector<Vec2> positions;
    for (const RobotNow& robot : walk.at(moment.time_s)) positions.push_back(robot.position_m);
    if (positions.empty()) continue;
    const DensityMoment now{
        .time_s = moment.time_s,
        .flown_per_m2 = peak_density_per_m2(positions),
        .planned_per_m2 = planned_peak_density_per_m2(moment.mixture(), run.tracks.size())};
    course.worst_per_m2 = std::max(course.worst_per_m2, now.flown_per_m2);
    course.planned_worst_per_m2 = std::max(course.planned_worst_per_m2, now.planned_per_m2);
    peaks.push_back(now.flown_per_m2);
    course.moments.push_back(now);
  }
  if (peaks.empty()) return std::nullopt;
  if (course.cap_per_m2) {
    const auto dense = std::count_if(peaks.begin(), peaks.end(), [&](double peak) {
      return peak > kDense * *course.cap_per_m2;
    });
    course.dense_share = static_cast<double>(dense) / static_cast<double>(peaks.size());
  }
  course.p95_per_m2 = quantile(peaks, 0.95);
  return course;
}

}  // namespace swarm::monitor
