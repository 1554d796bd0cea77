// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/swarm_walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swarm::monitor {

SwarmWalk::SwarmWalk(std::span<const Track> tracks) : tracks_(tracks), cursors_(tracks.size(), 0) {}

/// Advances each robot's cursor to its last step before `time_s`; moments must ascend. A robot that
/// was lost disappears after its last step, one that ended gracefully stays at its last position.
const std::vector<RobotNow>& SwarmWalk::at(double time_s) {
  robots_.clear();
  for (std::uint32_t i = 0; i < tracks_.size(); ++i) {
    const auto& points = tracks_[i].points;
    if (points.empty() || points.front().time_s > time_s) continue;
    std::size_t& k = cursors_[i];
    while (k + 1 < points.size() && points[k + 1].time_s <= time_s) ++k;
    RobotNow robot{.robot = i, .position_m = points[k].position_m, .step = &points[k]};
    if (k + 1 < points.size()) {
      const double share = (time_s - points[k].time_s) / (points[k + 1].time_s - points[k].time_s);
      robot.position_m += share * (points[k + 1].position_m - points[k].position_m);
    } else if (!tracks_[i].ended_gracefully && time_s > points[k].time_s) {
      continue;
    }
    robots_.push_back(robot);
  }
  return robots_;
}

/// Before the first motion the swarm waits for its start, which would count as perfect tracking.
std::optional<MotionSpan> motion_of(std::span<const Track> tracks) {
  MotionSpan span{.begin_s = std::numeric_limits<double>::infinity()};
  for (const Track& track : tracks) {
    if (track.points.empty()) continue;
    span.end_s = std::max(span.end_s, track.points.back().time_s);
    const auto moving =
        std::find_if(track.points.begin(), track.points.end(),
                     [](const TrackPoint& point) { return point.mode == RobotMode::kMoving; });
    if (moving != track.points.end()) span.begin_s = std::min(span.begin_s, moving->time_s);
  }
  if (!std::isfinite(span.begin_s)) return std::nullopt;
  return span;
}

double arrived_share(std::span<const RobotNow> robots) {
  if (robots.empty()) return 0.0;
  const auto arrived = std::count_if(robots.begin(), robots.end(), [](const RobotNow& robot) {
    return robot.step->mode == RobotMode::kArrived;
  });
  return static_cast<double>(arrived) / static_cast<double>(robots.size());
}

}  // namespace swarm::monitor
