// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/fallen_bodies.hpp"

#include <algorithm>

#include "swarm_core/mission/scene_bodies.hpp"

namespace swarm::monitor {
namespace {

/// Where the log of a dead robot lacks its end, as the disk was full, the launcher knows more: the
/// last status. Its circle covers the end of every complete log.
void end_where_it_fell(const FallenBody& body, double fallen_s, Track& track) {
  const TrackPoint& last = track.points.back();
  const bool is_covered = (last.position_m - body.shape.center_m).norm() <= body.shape.radius_m;
  if (track.body_until_s <= 0.0 || fallen_s <= last.time_s || is_covered) return;
  TrackPoint fell = last;
  fell.time_s = fallen_s;
  fell.position_m = body.shape.center_m;
  track.points.push_back(fell);
  ++track.lost;
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
    end_where_it_fell(body, to_seconds(body.from - run.begin), track);
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
