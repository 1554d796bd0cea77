// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/estimate_error.hpp"

#include <algorithm>
#include <vector>

#include "swarm_monitor/audit/quantile.hpp"

namespace swarm::monitor {
namespace {

/// Position on a track by linear interpolation between its steps; empty outside the track's time,
/// where nothing is known of the robot. O(log points).
std::optional<Vec2> position_at(const Track& track, double time_s) {
  const auto& points = track.points;
  if (points.empty() || time_s < points.front().time_s || time_s > points.back().time_s) {
    return std::nullopt;
  }
  const auto after =
      std::lower_bound(points.begin(), points.end(), time_s,
                       [](const TrackPoint& point, double t) { return point.time_s < t; });
  if (after == points.begin()) return after->position_m;
  const TrackPoint& before = *std::prev(after);
  const double share = (time_s - before.time_s) / (after->time_s - before.time_s);
  return Vec2(before.position_m + share * (after->position_m - before.position_m));
}

}  // namespace

/// Errors are reported in cm because they are a few cm large.
std::optional<EstimateError> estimate_error(std::span<const Track> tracks) {
  std::vector<double> errors_cm;
  for (const Track& track : tracks) {
    for (const EstimatePoint& estimate : track.estimates) {
      if (estimate.neighbour.value() >= tracks.size()) continue;
      const auto truth = position_at(tracks[estimate.neighbour.value()], estimate.time_s);
      if (truth) errors_cm.push_back(100.0 * (estimate.position_m - *truth).norm());
    }
  }
  if (errors_cm.empty()) return std::nullopt;
  return EstimateError{.p50_cm = quantile(errors_cm, 0.5),
                       .p99_cm = quantile(errors_cm, 0.99),
                       .p999_cm = quantile(errors_cm, 0.999),
                       .max_cm = quantile(errors_cm, 1.0)};
}

}  // namespace swarm::monitor
