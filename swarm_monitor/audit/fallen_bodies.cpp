// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/fallen_bodies.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>

#include "swarm_core/app/file_watch.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
#include "swarm_core/robot_log/last_step.hpp"
#include "swarm_core/robot_log/record.hpp"

namespace swarm::monitor {
namespace {

/// The robot that an event about an incomplete log names; empty for other events.
std::optional<std::uint32_t> robot_without_end(const RunEvent& event) {
  constexpr std::string_view kBegin = "robot ";
  if (event.code != shell::kLogIncomplete || !event.text.starts_with(kBegin)) return std::nullopt;
  std::uint32_t robot = 0;
  const char* const end = event.text.data() + event.text.size();
  const auto parsed = std::from_chars(event.text.data() + kBegin.size(), end, robot);
  return parsed.ec == std::errc{} ? std::optional(robot) : std::nullopt;
}

/// Where the log of a dead robot lacks its end, as the disk was full, the launcher knew more. How
/// the robot drove on and where in the launcher's circle its body is was not recorded: it is not
/// judged, and its log counts as incomplete.
void leave_out_body(double known_s, Track& track) {
  // A frozen robot may have written its log later.
  if (track.body_until_s <= 0.0 || known_s <= track.points.back().time_s) return;
  track.body_until_s = 0.0;
  ++track.lost;
}

/// The circle of a robot whose log is whole covers the end of the log.
bool covers_end(const Circle& circle, const Track& track) {
  return (track.points.back().position_m - circle.center_m).norm() <= circle.radius_m;
}

/// Adds a point to a track, unless the log has it or another one at that time.
void add_point(TrackPoint point, Track& track) {
  constexpr double kSame_s = 1e-6;
  const auto next =
      std::ranges::lower_bound(track.points, point.time_s - kSame_s, {}, &TrackPoint::time_s);
  if (next != track.points.end() && next->time_s <= point.time_s + kSame_s) return;
  track.points.insert(next, point);
}

/// Completes the log of a robot whose process was killed or frozen by its last step, if no more
/// than the records that the process had not handed to the disk are missing: over a longer time the
/// path would not be known.
void add_last_step(const RunEvent& event, RecordedRun& run) {
  constexpr double kLongest_s = 3.0;
  if (event.code != robot_log::kLastStepCode) return;
  const auto step = robot_log::parse_last_step(event.text);
  if (!step || step->robot.value() >= run.tracks.size()) return;
  Track& track = run.tracks[step->robot.value()];
  const double time_s = to_seconds(step->stamp - run.begin);
  const auto next = std::ranges::upper_bound(track.points, time_s, {}, &TrackPoint::time_s);
  if (next == track.points.begin() || time_s - std::prev(next)->time_s > kLongest_s) return;
  TrackPoint point = *std::prev(next);
  point.time_s = time_s;
  point.position_m = step->position_m;
  add_point(point, track);
  const Duration period = from_seconds(1.0 / run.mission.control.rate_hz);
  point.time_s += to_seconds(robot_log::command_lifetime(period));
  point.position_m = robot_log::rest_position_m(
      {.position_m = step->position_m, .velocity_mps = step->velocity_mps}, period);
  add_point(point, track);
}

}  // namespace

/// Times are those of the tracks, since RecordedRun::begin. A body lies until the end of the run
/// unless a scene cleared it.
void lay_fallen_bodies(RecordedRun& run) {
  for (const RunEvent& event : run.events) add_last_step(event, run);
  double end_s = 0.0;
  for (const Track& track : run.tracks) {
    if (!track.points.empty()) end_s = std::max(end_s, track.points.back().time_s);
  }
  for (Track& track : run.tracks) {
    if (!track.ended_gracefully && !track.points.empty()) track.body_until_s = end_s;
  }
  for (const RunEvent& event : run.events) {
    const auto robot = robot_without_end(event);
    if (robot && *robot < run.tracks.size()) leave_out_body(event.time_s, run.tracks[*robot]);
  }
  for (const FallenBody& body : bodies_of(run.scenes)) {
    const std::uint32_t robot = body.robot.value();
    if (robot >= run.tracks.size() || run.tracks[robot].points.empty()) continue;
    Track& track = run.tracks[robot];
    if (!covers_end(body.shape, track)) leave_out_body(to_seconds(body.from - run.begin), track);
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
