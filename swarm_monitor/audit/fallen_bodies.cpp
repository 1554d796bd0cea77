// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/fallen_bodies.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

#include "swarm_core/app/file_watch.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
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

/// How far a robot drives while its process collects records before it writes them: a process that
/// is killed leaves a log that ends so far from the robot's last step. 0 if it writes at once.
double unwritten_m(const RecordedRun& run, const Track& track) {
  if (track.processes.empty()) return 0.0;
  const auto together = std::ranges::count_if(run.tracks, [&](const Track& other) {
    return !other.processes.empty() && other.processes.back() == track.processes.back();
  });
  const Duration period = from_seconds(1.0 / run.mission.control.rate_hz);
  const Duration delay = robot_log::log_delay(static_cast<std::uint32_t>(together), period) -
                         robot_log::log_delay(1, period);
  return to_seconds(delay) * body_of(run.mission.robots, track.robot).speed_max_mps;
}

/// The circle of a robot whose log is whole covers the end of the log, or nearly so.
bool covers_end(const Circle& circle, const Track& track, double unwritten_m) {
  return (track.points.back().position_m - circle.center_m).norm() <= circle.radius_m + unwritten_m;
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
  for (const RunEvent& event : run.events) {
    const auto robot = robot_without_end(event);
    if (robot && *robot < run.tracks.size()) leave_out_body(event.time_s, run.tracks[*robot]);
  }
  for (const FallenBody& body : bodies_of(run.scenes)) {
    const std::uint32_t robot = body.robot.value();
    if (robot >= run.tracks.size() || run.tracks[robot].points.empty()) continue;
    Track& track = run.tracks[robot];
    if (!covers_end(body.shape, track, unwritten_m(run, track))) {
      leave_out_body(to_seconds(body.from - run.begin), track);
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
