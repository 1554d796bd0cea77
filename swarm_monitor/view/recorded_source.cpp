// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/recorded_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "swarm_monitor/audit/clearance.hpp"
#include "swarm_monitor/audit/tracking/plan_timeline.hpp"
#include "swarm_monitor/view/scene_json.hpp"
#include "swarm_monitor/view/view_frame.hpp"

namespace swarm::monitor {
namespace {

/// A robot that did not end gracefully is shown as lost this long after its last step.
constexpr double kLostAfter_s = 1.0;
/// An estimate is shown this long after it was logged; robots log them every half second.
constexpr double kEstimate_s = 2.0;

/// Index of the last point at or before a time; size() if there is none.
std::size_t index_at(const std::vector<TrackPoint>& points, double time_s) {
  const auto after =
      std::upper_bound(points.begin(), points.end(), time_s,
                       [](double t, const TrackPoint& point) { return t < point.time_s; });
  return after == points.begin() ? points.size()
                                 : static_cast<std::size_t>(after - points.begin()) - 1;
}

/// A robot at a time: position interpolated between its steps, heading along the line from the step
/// before to the step after, mode and neighbours of the last step.
FrameRobot robot_at(const Track& track, double time_s) {
  FrameRobot robot;
  const auto& points = track.points;
  const std::size_t i = index_at(points, time_s);
  if (i == points.size()) return robot;
  const TrackPoint& now = points[i];
  robot.was_received = true;
  robot.position_m = now.position_m;
  robot.mode = now.mode;
  robot.goal = now.goal;
  robot.neighbours = static_cast<std::uint8_t>(std::min<int>(now.neighbours, 255));
  robot.arrived = now.mode == RobotMode::kArrived;
  robot.lost = !track.ended_gracefully && time_s > points.back().time_s + kLostAfter_s;
  const TrackPoint& next = points[std::min(i + 1, points.size() - 1)];
  const TrackPoint& before = points[i > 0 ? i - 1 : 0];
  if (next.time_s > now.time_s) {
    const double share = (time_s - now.time_s) / (next.time_s - now.time_s);
    robot.position_m += std::clamp(share, 0.0, 1.0) * (next.position_m - now.position_m);
  }
  const Vec2 path = next.position_m - before.position_m;
  robot.heading_rad = std::atan2(path.y(), path.x());
  return robot;
}

/// The newest estimate of each neighbour, from the latest backwards until they are too old.
std::vector<FrameEstimate> estimates_at(const Track& track, double time_s) {
  std::vector<FrameEstimate> estimates;
  for (auto it = track.estimates.rbegin(); it != track.estimates.rend(); ++it) {
    if (it->time_s > time_s) continue;
    if (it->time_s < time_s - kEstimate_s) break;
    const bool newer_known =
        std::any_of(estimates.begin(), estimates.end(),
                    [&](const auto& known) { return known.neighbour == it->neighbour; });
    if (!newer_known) estimates.push_back({it->neighbour, it->position_m});
  }
  return estimates;
}

}  // namespace

/// Scenes, events and series of the whole run are computed at once: a recording does not change.
RecordedSource::RecordedSource(RecordedRun run) : run_(std::move(run)) {
  moving_from_s_ = std::numeric_limits<double>::infinity();
  for (const Track& track : run_.tracks) {
    if (!track.points.empty()) end_s_ = std::max(end_s_, track.points.back().time_s);
    for (const TrackPoint& point : track.points) {
      if (point.mode != RobotMode::kMoving) continue;
      moving_from_s_ = std::min(moving_from_s_, point.time_s);
      break;
    }
  }
  make_scenes();
  make_events();
  make_series();
}

void RecordedSource::make_scenes() {
  for (const WorldPhase& phase : world_phases(run_.mission.world, run_.scenes)) {
    // The goal of the newest scene made by then that has one; else the mission's.
    const Mixture* goal = &run_.mission.goal;
    for (const Scene& scene : run_.scenes) {
      const UtcTime made{Duration(static_cast<std::int64_t>(scene.version))};
      if (scene.goal && made <= phase.begin) goal = &*scene.goal;
    }
    const double from_s = scenes_.empty() ? 0.0 : to_seconds(phase.begin - run_.begin);
    scenes_.push_back(scene_json({.mission = run_.mission,
                                  .world = phase.world,
                                  .goal = *goal,
                                  .plan = run_.first_plan(),
                                  .plan_excess_m = run_.plan_excess_m(),
                                  .from_s = from_s,
                                  .end_s = end_s_}));
  }
}

void RecordedSource::make_events() {
  for (const RunEvent& event : run_.events) events_.push_back(event_json(event));
}

/// One row per second with the smallest gap in that second, or fewer in a long recording: the stamp
/// of a damaged record may lie years ahead. Latency and rate are not in the logs.
void RecordedSource::make_series() {
  constexpr double kMostRows = 20'000.0;
  const Clearance clearance = robot_clearance(run_.tracks);
  const auto step_s = static_cast<std::size_t>(std::clamp(std::ceil(end_s_ / kMostRows), 1.0, 1e9));
  const auto rows =
      static_cast<std::size_t>(std::ceil(std::min(end_s_, 1e9) / static_cast<double>(step_s))) + 1;
  for (std::size_t k = 0; k < rows; ++k) {
    const std::size_t i = k * step_s;
    SeriesRow row{.time_s = static_cast<double>(i),
                  .nearest_gap_m = std::numeric_limits<double>::quiet_NaN(),
                  .latency_ms = std::numeric_limits<double>::quiet_NaN(),
                  .rate_hz = std::numeric_limits<double>::quiet_NaN()};
    for (std::size_t s = i; s < std::min(i + step_s, clearance.by_window_m.size()); ++s) {
      row.nearest_gap_m = std::fmin(row.nearest_gap_m, clearance.by_window_m[s]);
    }
    for (const Track& track : run_.tracks) {
      const std::size_t at = index_at(track.points, row.time_s);
      if (at == track.points.size()) continue;
      row.arrived += track.points[at].mode == RobotMode::kArrived ? 1 : 0;
      row.moving += track.points[at].mode == RobotMode::kMoving ? 1 : 0;
    }
    series_.push_back(series_json(row));
  }
}

/// Frames of any time: the page can move in a recording. The mixture follows the published clock.
void RecordedSource::view_frame(std::optional<double> time_s, std::optional<RobotId> focus,
                                std::vector<std::byte>& out) {
  const double t = std::clamp(time_s.value_or(end_s_), 0.0, end_s_);
  std::optional<Mixture> mixture;
  if (const auto moment = PlanTimeline(run_).at(t)) {
    mixture = moment->mixture();
  } else if (run_.clock.empty() && run_.first_plan() != nullptr) {
    // Runs recorded before there was a plan clock: plan time is taken to begin with the motion.
    mixture = run_.first_plan()->mixture_at(MissionTime(std::max(0.0, t - moving_from_s_)));
  }
  ViewFrameEncoder maker(
      out, static_cast<std::uint32_t>(run_.tracks.size()), t,
      t >= end_s_ ? kEndedPhase : static_cast<std::uint32_t>(MissionPhase::kRunning), mixture);
  maker.set_origin(origin_m());
  for (const Track& track : run_.tracks) maker.add(robot_at(track, t));
  const bool known = focus && focus->value() < run_.tracks.size();
  maker.finish(known ? focus : std::nullopt,
               known ? estimates_at(run_.tracks[focus->value()], t) : std::vector<FrameEstimate>{});
}

std::string RecordedSource::metrics() const {
  return fmt::format(
      "# HELP swarm_robots Robots of the mission.\n# TYPE swarm_robots gauge\nswarm_robots {}\n"
      "# HELP swarm_recording_seconds Length of the recording.\n"
      "# TYPE swarm_recording_seconds gauge\nswarm_recording_seconds {}\n",
      run_.tracks.size(), end_s_);
}

}  // namespace swarm::monitor
