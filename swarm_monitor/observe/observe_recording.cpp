// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <vector>

#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarmflow/observe/observer.hpp"

namespace swarm::monitor {
namespace {

/// The index of a point of a robot, or of an event; events have the robot number after the last
/// robot.
struct Item {
  double time_s = 0.0;
  std::size_t robot = 0;
  std::size_t index = 0;
};

/// All points and events in order of time. The sort is stable, so that points of equal time keep
/// the order of robots and each robot's points their own.
std::vector<Item> in_order_of_time(const RecordedRun& run) {
  std::vector<Item> items;
  for (std::size_t robot = 0; robot < run.tracks.size(); ++robot) {
    const std::vector<TrackPoint>& points = run.tracks[robot].points;
    for (std::size_t i = 0; i < points.size(); ++i) items.push_back({points[i].time_s, robot, i});
  }
  for (std::size_t i = 0; i < run.events.size(); ++i) {
    items.push_back({run.events[i].time_s, run.tracks.size(), i});
  }
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.time_s < b.time_s; });
  return items;
}

/// Velocity over the piece after point i: between two points a robot moves in a straight line.
Vec2 velocity_after(const std::vector<TrackPoint>& points, std::size_t i) {
  if (i + 1 >= points.size()) return Vec2::Zero();
  const double lasts_s = points[i + 1].time_s - points[i].time_s;
  return (points[i + 1].position_m - points[i].position_m) / lasts_s;
}

}  // namespace

/// Plans and scenes come first; states and
/// events follow in order of time.
Result<void> observe_recording(const std::filesystem::path& from, Observer& observer) {
  const auto run = read_run(from);
  if (!run) return tl::unexpected(run.error());
  observer.on_mission(run->mission);
  for (const PublishedPlan& plan : run->plans) {
    observer.on_plan({.flow = plan.plan, .version = plan.version, .excess_m = plan.excess_m});
  }
  for (const Scene& scene : run->scenes) {
    if (scene.version != 0) observer.on_scene(scene);
  }
  std::vector<std::uint32_t> sequences(run->tracks.size());
  for (const Item& item : in_order_of_time(*run)) {
    const UtcTime at = run->begin + from_seconds(item.time_s);
    if (item.robot == run->tracks.size()) {
      const RunEvent& event = run->events[item.index];
      observer.on_event({.received = at,
                         .stamp = at,
                         .source = event.source,
                         .severity = event.severity,
                         .code = event.code,
                         .text = event.text});
      continue;
    }
    const Track& track = run->tracks[item.robot];
    const TrackPoint& point = track.points[item.index];
    observer.on_state({.robot = track.robot,
                       .sequence = ++sequences[item.robot],
                       .stamp = at,
                       .received = at,
                       .position_m = point.position_m,
                       .velocity_mps = velocity_after(track.points, item.index),
                       .mode = point.mode});
  }
  return {};
}

}  // namespace swarm::monitor
