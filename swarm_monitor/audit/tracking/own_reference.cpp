// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/own_reference.hpp"

#include <cmath>
#include <map>

#include "swarm_monitor/audit/quantile.hpp"
#include "swarm_monitor/audit/tracking/reference_curve.hpp"
#include "swarm_monitor/audit/tracking/swarm_walk.hpp"

namespace swarm::monitor {
namespace {

/// The reference curves of one robot, one per plan version that it followed.
using Curves = std::map<std::uint32_t, ReferenceCurve>;

Curves curves_of(const Track& track) {
  Curves curves;
  ReferenceCurve* curve = nullptr;
  std::uint32_t version = 0;
  // Points of one version are usually contiguous, so the map is searched only when the version
  // changes.
  for (const TrackPoint& point : track.points) {
    if (point.plan_version == 0) continue;
    if (point.plan_version != version) {
      version = point.plan_version;
      curve = &curves[version];
    }
    curve->add(point.plan_time_s, point.reference_m());
  }
  return curves;
}

/// Largest difference between the plan time that one robot logged and the published plan time at
/// the same moment [s]; empty if the robot followed no published plan.
std::optional<double> clock_error_s(const Track& track, const PlanTimeline& timeline,
                                    const MotionSpan& motion) {
  std::optional<double> worst;
  for (const TrackPoint& point : track.points) {
    if (point.plan_version == 0 || point.time_s < motion.begin_s) continue;
    const auto moment = timeline.at(point.time_s);
    if (!moment || moment->published->version != point.plan_version) continue;
    const double error_s = std::abs(static_cast<double>(point.plan_time_s) - moment->plan_time_s);
    worst = std::max(worst.value_or(0.0), error_s);
  }
  return worst;
}

/// Quantiles of the signed lags, and of their amounts: early robots break the density cap as late
/// ones do.
LagQuantiles quantiles_of(std::vector<double> lags) {
  LagQuantiles q{.p1_s = quantile(lags, 0.01),
                 .p10_s = quantile(lags, 0.1),
                 .p50_s = quantile(lags, 0.5),
                 .p90_s = quantile(lags, 0.9),
                 .p99_s = quantile(lags, 0.99)};
  for (double& lag : lags) lag = std::abs(lag);
  q.amount_p90_s = quantile(lags, 0.9);
  q.amount_p99_s = quantile(lags, 0.99);
  return q;
}

/// Median, 95 % and root mean square of distances.
ReferenceError error_of(std::vector<double> distances) {
  double squares = 0.0;
  for (const double d : distances) squares += d * d / static_cast<double>(distances.size());
  return {.p50_m = quantile(distances, 0.5),
          .p95_m = quantile(distances, 0.95),
          .rms_m = std::sqrt(squares)};
}

}  // namespace

/// Two measures per robot and moment: the lag on its own curve, for all robots of the plan in
/// force, and the distance to the reference, for robots in motion only (a robot at rest in its slot
/// would dilute it).
OwnReference own_reference(const RecordedRun& run, std::span<const PlanMoment> moments) {
  OwnReference result;
  std::vector<Curves> curves;
  for (const Track& track : run.tracks) curves.push_back(curves_of(track));
  std::vector<double> lags, distances;
  std::size_t under_way = 0, followed = 0;
  SwarmWalk walk(run.tracks);
  for (const PlanMoment& moment : moments) {
    const std::uint32_t version = moment.published->version;
    std::vector<double> lags_now;
    for (const RobotNow& robot : walk.at(moment.time_s)) {
      const bool moves = robot.step->mode == RobotMode::kMoving;
      if (moves) ++under_way;
      if (robot.step->plan_version != version) continue;
      const ReferenceCurve& curve = curves[robot.robot].at(version);
      lags_now.push_back(curve.lag_s(robot.position_m, moment.plan_time_s));
      if (!moves) continue;
      ++followed;
      distances.push_back((robot.position_m - curve.at(moment.plan_time_s)).norm());
    }
    if (lags_now.empty()) continue;
    lags.insert(lags.end(), lags_now.begin(), lags_now.end());
    result.moments.push_back({.time_s = moment.time_s,
                              .p10_s = quantile(lags_now, 0.1),
                              .p50_s = quantile(lags_now, 0.5),
                              .p90_s = quantile(lags_now, 0.9)});
  }
  if (!lags.empty()) result.lag = quantiles_of(std::move(lags));
  if (!distances.empty()) result.error = error_of(std::move(distances));
  if (under_way > 0) {
    result.followed_share = static_cast<double>(followed) / static_cast<double>(under_way);
  }
  const auto motion = motion_of(run.tracks);
  if (!motion) return result;
  const PlanTimeline timeline(run);
  for (const Track& track : run.tracks) {
    const auto error_s = clock_error_s(track, timeline, *motion);
    if (!error_s) continue;
    result.clock_error_s = std::max(result.clock_error_s.value_or(0.0), *error_s);
  }
  return result;
}

}  // namespace swarm::monitor
