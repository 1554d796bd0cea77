// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/fallen_bodies.hpp"

#include <algorithm>

#include "swarm_core/mission/scene_bodies.hpp"

namespace swarm::monitor {
namespace {

/// Where the log of a dead robot lacks its end, as the disk was full, the launcher knew more: its
/// circle covers the end of every complete log. How the robot got there and where in the circle its
/// body is was not recorded: it is not judged, and its log counts as incomplete.
bool has_complete_log(const FallenBody& body, double fallen_s, const Track& track) {
  const TrackPoint& last = track.points.back();
  return fallen_s <= last.time_s ||
         (last.position_m - body.shape.center_m).norm() <= body.shape.radius_m;
}

}  // namespace

/// Times are those of the tracks, since RecordedRun::begin. A body lies until the end of the run
/// unless a scene cleared it.
void lay_fallen_bodies(RecordedRun& run) {
  double end_s = 0.0;
  for (const Track& track : run.tracks) {
    if (!track.points.empty()) end_s = std::max(end_s, track.points.back().time_s);
  }
  for (Track& track : run.tracks) {
    if (!track.ended_gracefully && !track.points.empty()) track.body_until_s = end_s;
  }
  for (const FallenBody& body : bodies_of(run.scenes)) {
    const std::uint32_t robot = body.robot.value();
    if (robot >= run.tracks.size() || run.tracks[robot].points.empty()) continue;
    Track& track = run.tracks[robot];
    if (track.body_until_s > 0.0 &&
        !has_complete_log(body, to_seconds(body.from - run.begin), track)) {
      track.body_until_s = 0.0;
      ++track.lost;
    }
    if (!body.cleared) continue;
    const double cleared_s = to_seconds(*body.cleared - run.begin);
    // A body of an earlier incarnation was cleared when the robot came back: its log continues
    // after that, and the robot is its own body.
    if (track.body_until_s > 0.0 && cleared_s >= track.points.back().time_s) {
      track.body_until_s = std::min(track.body_until_s, cleared_s);
    }
  }
}

}  // namespace swarm::monitor
