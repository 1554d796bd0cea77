// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/plan_deviation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swarm::monitor {
namespace {

struct Moments {
  Vec2 centre = Vec2::Zero();
  double spread_m = 0.0;
};

Moments planned_at(const FlowPlan& plan, double time_s) {
  const Mixture mixture = plan.mixture_at(MissionTime(time_s));
  Moments m;
  for (const WeightedGaussian& c : mixture.components()) m.centre += c.weight * c.gaussian.mean_m();
  double variance = 0.0;
  for (const WeightedGaussian& c : mixture.components()) {
    variance += c.weight * (c.gaussian.covariance_m2().trace() +
                            (c.gaussian.mean_m() - m.centre).squaredNorm());
  }
  m.spread_m = std::sqrt(variance);
  return m;
}

/// `cursors`: of each track the point reached before.
Moments real_at(const RecordedRun& run, double time_s, std::vector<std::size_t>& cursors) {
  std::vector<Vec2> positions;
  for (std::size_t i = 0; i < run.tracks.size(); ++i) {
    const auto& points = run.tracks[i].points;
    while (cursors[i] + 1 < points.size() && points[cursors[i] + 1].time_s <= time_s) ++cursors[i];
    if (!points.empty()) positions.push_back(points[cursors[i]].position_m);
  }
  Moments m;
  for (const Vec2& p : positions) m.centre += p / static_cast<double>(positions.size());
  double variance = 0.0;
  for (const Vec2& p : positions) {
    variance += (p - m.centre).squaredNorm() / static_cast<double>(positions.size());
  }
  m.spread_m = std::sqrt(variance);
  return m;
}

}  // namespace

PlanDeviation plan_deviation(const RecordedRun& run) {
  double begin_s = std::numeric_limits<double>::infinity(), end_s = 0.0;
  for (const Track& track : run.tracks) {
    if (!track.points.empty()) end_s = std::max(end_s, track.points.back().time_s);
    const auto moving =
        std::find_if(track.points.begin(), track.points.end(),
                     [](const TrackPoint& point) { return point.mode == RobotMode::kMoving; });
    if (moving != track.points.end()) begin_s = std::min(begin_s, moving->time_s);
  }
  PlanDeviation deviation;
  if (run.plans.empty() || !std::isfinite(begin_s)) return deviation;
  deviation.begin_s = begin_s;
  std::vector<std::size_t> cursors(run.tracks.size(), 0);
  for (double t = begin_s; t <= end_s; t += PlanDeviation::kStep_s) {
    const Moments planned = planned_at(*run.first_plan(), t - begin_s);
    const Moments real = real_at(run, t, cursors);
    deviation.centre_off_m.push_back((planned.centre - real.centre).norm());
    deviation.planned_spread_m.push_back(planned.spread_m);
    deviation.real_spread_m.push_back(real.spread_m);
  }
  return deviation;
}

}  // namespace swarm::monitor
