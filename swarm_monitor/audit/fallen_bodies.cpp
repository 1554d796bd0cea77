// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/fallen_bodies.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

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

/// The launcher found at the same time that the log of this robot lacks more than that.
bool is_incomplete(const RunEvent& last_step, std::uint32_t robot, const RecordedRun& run) {
  return std::ranges::any_of(run.events, [&](const RunEvent& other) {
    return other.time_s == last_step.time_s && robot_without_end(other) == robot;
  });
}

/// Completes the log of a robot whose process was killed or frozen by its last step, if no more
/// than the records that the process had not handed to the disk are missing: over a longer time the
/// path would not be known. The body then comes to rest after that step, and not after the log's
/// last one.
void add_last_step(const RunEvent& event, RecordedRun& run) {
  if (event.source != "launcher" || event.code != robot_log::kLastStepCode) return;
  const auto step = robot_log::parse_last_step(event.text);
  if (!step || step->robot.value() >= run.tracks.size()) return;
  if (is_incomplete(event, step->robot.value(), run)) return;
  std::vector<TrackPoint>& points = run.tracks[step->robot.value()].points;
  const Duration period = from_seconds(1.0 / run.mission.control.rate_hz);
  const double longest_s = to_seconds(robot_log::log_delay(robot_log::kManyRobots, period));
  constexpr double kSame_s = 1e-6;
  const double time_s = to_seconds(step->stamp - run.begin);
  const auto is_step = [](const TrackPoint& point) { return !point.is_rest; };
  const auto begin = std::ranges::upper_bound(points, time_s + kSame_s, {}, &TrackPoint::time_s);
  const auto before = std::find_if(std::reverse_iterator(begin), points.rend(), is_step);
  if (before == points.rend() || time_s - before->time_s > longest_s) return;
  if (time_s - before->time_s < kSame_s) return;  // the log has it
  TrackPoint point = *before;
  auto next = points.erase(before.base(), std::find_if(begin, points.end(), is_step));
  point.time_s = time_s;
  point.position_m = step->position_m;
  next = std::next(points.insert(next, point));
  point.is_rest = true;
  point.time_s += to_seconds(robot_log::command_lifetime(period));
  point.position_m = robot_log::rest_position_m(
      {.position_m = step->position_m, .velocity_mps = step->velocity_mps}, period);
  if (next == points.end() || next->time_s > point.time_s) points.insert(next, point);
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
