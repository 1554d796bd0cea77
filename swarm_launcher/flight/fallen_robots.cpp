// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/fallen_robots.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "swarm_core/app/file_watch.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
#include "swarm_core/robot_log/last_step.hpp"

namespace swarm::launcher {
namespace {

/// A circle that would become smaller by less stays.
constexpr double kSmaller_m = 0.05;
constexpr Duration kStarting = std::chrono::seconds(5);

bool contains(const Circle& outer, const Circle& inner) {
  constexpr double kNoise_m = 0.02;
  const double apart_m = (inner.center_m - outer.center_m).norm();
  return apart_m + inner.radius_m <= outer.radius_m + kNoise_m;
}

/// Whether a robot that makes steps stands, as one does that is cut off or has just been restarted:
/// by its command and by its motion since the step before. Measurements have noise.
bool stands(const LastKnown& known) {
  constexpr double kNone_mps = 0.05;
  return known.command_mps->norm() < kNone_mps && known.speed_mps.value_or(0.0) < kNone_mps;
}

}  // namespace

FallenRobots::FallenRobots(const Mission& mission, SceneKeeper& scene, FlightLog& log, Here here,
                           RecordedPositions recorded)
    : mission_(mission),
      scene_(scene),
      log_(log),
      here_(std::move(here)),
      recorded_(std::move(recorded)),
      reported_(mission.robots.count) {}

/// Whether the process of a robot on this host was started a short time ago: it may make steps
/// before its first status arrives, which clears the body.
bool FallenRobots::is_starting(RobotId robot, SteadyTime now) const {
  if (robot.value() >= here_.robots) return false;
  const std::optional<Duration> runs_for = here_.runs_for(robot, now);
  return runs_for && *runs_for < kStarting;
}

/// Whether a robot on this host does not drive on from this step: its process has ended, is frozen,
/// has been started again and made no step yet, or the robot stands.
bool FallenRobots::is_last(RobotId robot, const LastKnown& step, const FlightTime& now) const {
  const Duration age = now.utc - step.at;
  const std::optional<Duration> runs_for = here_.runs_for(robot, now.steady);
  return !runs_for || *runs_for < age || age > longest_between_steps(mission_) || stands(step);
}

/// A stamp of the future would outrank each status. Of a robot on another host that host reports
/// whether this is its last step.
std::optional<LastKnown> FallenRobots::last_step(RobotId robot, const FlightTime& now) const {
  std::optional<LastKnown> known = recorded_.last_step(robot);
  if (!known) return std::nullopt;
  known->at = std::min(known->at, now.utc);
  if (robot.value() < here_.robots) known->is_last = is_last(robot, *known, now);
  return known;
}

/// The newest known position of a robot: its last step has a command and is exact, a status is up
/// to a second old, and the disk may lack the end of a log.
std::optional<LastKnown> FallenRobots::newest_of(RobotId robot, const FlightTime& now) const {
  std::optional<LastKnown> newest = last_step(robot, now);
  if (!newest) {  // its process was started by hand, and shares no steps
    newest = recorded_.in_log(robot);
    if (newest) newest->command_mps.reset();
  }
  const std::optional<LastKnown>& reported = reported_.at(robot.value());
  return !newest || (reported && reported->at > newest->at) ? reported : newest;
}

/// An audit has the body of a dead robot where its log ends. The log may lack the last records,
/// which the process had not handed to the disk: this event has the last step.
void FallenRobots::report_last_step(RobotId robot, const FlightTime& now) {
  const std::optional<LastKnown> known = newest_of(robot, now);
  if (!known || !known->is_last || !known->command_mps) return;  // or a status that is newer
  const robot_log::LastStep step{.robot = robot,
                                 .stamp = known->at,
                                 .position_m = known->position_m,
                                 .velocity_mps = *known->command_mps};
  log_.log(now.utc,
           {.code = std::string(robot_log::kLastStepCode), .text = robot_log::to_text(step)});
}

/// An audit has to know of a log that ends earlier, as the disk was full or slow.
void FallenRobots::report_incomplete_log(RobotId robot, const FlightTime& now) {
  if (robot.value() >= here_.robots) return;
  const std::optional<LastKnown> logged = recorded_.in_log(robot);
  const std::optional<LastKnown> newest = newest_of(robot, now);
  if (!logged || !newest) return;
  const Duration lacks = newest->at - logged->at;
  if (lacks <= here_.log_delay) return;
  log_.log(now.utc, {.warning = true,
                     .code = std::string(shell::kLogIncomplete),
                     .text = fmt::format("robot {}: its log ends {:.1f} s before its last step",
                                         robot.value(), to_seconds(lacks))});
  // A frozen process may write the rest later, one that has ended never will, and no successor
  // knows what its queue held.
  if (!here_.runs_for(robot, now.steady)) {
    log_.add_loss(fmt::format("robot {}: the last {:.1f} s of the log of a process that ended",
                              robot.value(), to_seconds(lacks)));
  }
}

// All bodies in one change of the scene, since each change causes a new plan. Before anything is
// read from the disk, which may be slow.
void FallenRobots::add(std::span<const RobotId> robots, const FlightTime& now) {
  std::vector<SceneChange> changes;
  std::vector<RobotId> added, unknown;
  for (const RobotId robot : robots) {
    const std::optional<LastKnown> known = newest_of(robot, now);
    (known ? added : unknown).push_back(robot);
    if (known)
      changes.emplace_back(AddBody{robot, circle_of_fallen(*known, now.utc, mission_, robot)});
  }
  const std::vector<Error> refused = scene_.change_all(changes, now.utc);
  std::vector<RobotId> without_room;
  for (const RobotId robot : added) {
    if (!has_body(scene_.scene(), robot)) without_room.push_back(robot);
  }
  std::erase_if(added, [&](RobotId robot) { return !has_body(scene_.scene(), robot); });
  without_room_.insert(without_room.begin(), without_room.end());
  if (!added.empty()) {
    log_.log(now.utc, {.warning = true,
                       .code = "body-added",
                       .text = fmt::format(
                           "robots not received any more stay where they are, as obstacles: {}",
                           describe(added))});
  }
  if (!unknown.empty()) {
    log_.log(now.utc, {.warning = true,
                       .code = "body-unknown",
                       .text = fmt::format("robots at unknown positions, others may touch them: {}",
                                           describe(unknown))});
  }
  if (!refused.empty()) {
    log_.log(now.utc, {.warning = true,
                       .code = "body-refused",
                       .text = fmt::format("robots not received any more that cannot be obstacles, "
                                           "others may touch them: {}; {}",
                                           describe(without_room), refused.front().message)});
  }
  for (const RobotId robot : robots) {
    report_last_step(robot, now);
    report_incomplete_log(robot, now);
  }
}

/// Bodies for which the scene had no room, as far as it has some now.
void FallenRobots::add_waiting(const FlightTime& now, std::vector<SceneChange>& changes,
                               std::vector<RobotId>& changed) {
  std::size_t room =
      Scene::kMaxObstacles - std::min(Scene::kMaxObstacles, scene_.scene().obstacles.size());
  for (auto it = without_room_.begin(); it != without_room_.end() && room > 0; --room) {
    if (const auto known = newest_of(*it, now)) {
      changes.emplace_back(AddBody{*it, circle_of_fallen(*known, now.utc, mission_, *it)});
      changed.push_back(*it);
    }
    it = without_room_.erase(it);
  }
}

void FallenRobots::update(const FlightTime& now) {
  if (now.steady < next_update_) return;
  next_update_ = now.steady + kPeriod;
  std::vector<SceneChange> changes;
  std::vector<RobotId> changed;
  add_waiting(now, changes, changed);
  for (const SceneObstacle& obstacle : scene_.scene().obstacles) {
    const auto* body = std::get_if<Circle>(&obstacle.shape);
    if (!obstacle.owner || body == nullptr) continue;
    const RobotId robot = *obstacle.owner;
    if (is_starting(robot, now.steady)) continue;
    const std::optional<LastKnown> known = last_step(robot, now);
    const std::optional<LastKnown>& reported = reported_.at(robot.value());
    if (!known || (reported && reported->at > known->at)) continue;
    const Circle circle = circle_of_fallen(*known, now.utc, mission_, robot);
    if (contains(*body, circle) && circle.radius_m > body->radius_m - kSmaller_m) continue;
    changes.emplace_back(AddBody{robot, circle});
    changed.push_back(robot);
  }
  if (changes.empty()) return;
  scene_.change_all(changes, now.utc);
  log_.log(now.utc, {.code = "body-changed",
                     .text = fmt::format("their last steps are known better, or they made more: {}",
                                         describe(changed))});
  for (const RobotId robot : changed) report_last_step(robot, now);
}

/// Robots that report again. The operator may have cleared the body of some already.
void FallenRobots::clear(std::span<const RobotId> robots, UtcTime now) {
  std::vector<SceneChange> changes;
  std::vector<RobotId> cleared;
  for (const RobotId robot : robots) {
    without_room_.erase(robot);
    if (!has_body(scene_.scene(), robot)) continue;
    changes.emplace_back(ClearBody{robot});
    cleared.push_back(robot);
  }
  if (changes.empty()) return;
  scene_.change_all(changes, now);
  log_.log(now,
           {.code = "body-cleared",
            .text = fmt::format("received again, no obstacles any more: {}", describe(cleared))});
}

}  // namespace swarm::launcher
