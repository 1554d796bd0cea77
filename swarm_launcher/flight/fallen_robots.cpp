// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/fallen_robots.hpp"

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "swarm_core/app/file_watch.hpp"
#include "swarm_core/mission/scene_bodies.hpp"

namespace swarm::launcher {
namespace {

/// The radius of a robot's body as an obstacle; empty if it is none.
std::optional<double> body_radius_m(const Scene& scene, RobotId robot) {
  for (const SceneObstacle& obstacle : scene.obstacles) {
    const auto* circle = std::get_if<Circle>(&obstacle.shape);
    if (obstacle.owner == robot && circle != nullptr) return circle->radius_m;
  }
  return std::nullopt;
}

}  // namespace

FallenRobots::FallenRobots(const Mission& mission, SceneKeeper& scene, FlightLog& log,
                           std::uint32_t robots_here, Duration log_delay, LoggedPosition logged)
    : mission_(mission),
      scene_(scene),
      log_(log),
      robots_here_(robots_here),
      log_delay_(log_delay),
      logged_(std::move(logged)),
      reported_(mission.robots.count) {}

/// The newest known position of a robot. Its log has its last control period; its last status is up
/// to a second old.
const std::optional<LastKnown>& FallenRobots::newest_of(
    RobotId robot, const std::optional<LastKnown>& logged) const {
  const std::optional<LastKnown>& reported = reported_.at(robot.value());
  return !logged || (reported && reported->at > logged->at) ? reported : logged;
}

/// An audit has the body of a dead robot where its log ends: it has to know of one that the disk
/// has not taken whole.
void FallenRobots::report_incomplete_log(RobotId robot, const std::optional<LastKnown>& logged,
                                         UtcTime now) {
  const std::optional<LastKnown>& reported = reported_.at(robot.value());
  if (robot.value() >= robots_here_ || !reported || !logged) return;
  const Duration lacks = reported->at - logged->at;
  if (lacks <= log_delay_) return;
  log_.log(now, {.warning = true,
                 .code = std::string(shell::kLogIncomplete),
                 .text = fmt::format("robot {}: its log ends {:.1f} s before its last status",
                                     robot.value(), to_seconds(lacks))});
}

// All bodies in one change of the scene, since each change causes a new plan.
void FallenRobots::add(std::span<const RobotId> robots, UtcTime now) {
  std::vector<SceneChange> changes;
  std::vector<RobotId> added, unknown;
  for (const RobotId robot : robots) {
    const std::optional<LastKnown> logged = logged_(robot);
    const std::optional<LastKnown>& known = newest_of(robot, logged);
    (known ? added : unknown).push_back(robot);
    if (!known) continue;
    changes.emplace_back(AddBody{robot, circle_of_fallen(*known, now, mission_, robot)});
    report_incomplete_log(robot, logged, now);
  }
  const std::vector<Error> refused = scene_.change_all(changes, now);
  if (!added.empty()) {
    log_.log(now, {.warning = true,
                   .code = "body-added",
                   .text = fmt::format(
                       "robots not received any more stay where they are, as obstacles: {}",
                       describe(added))});
  }
  if (!unknown.empty()) {
    log_.log(now, {.warning = true,
                   .code = "body-unknown",
                   .text = fmt::format("robots at unknown positions, others may touch them: {}",
                                       describe(unknown))});
  }
  if (!refused.empty()) {
    log_.log(now, {.warning = true,
                   .code = "body-refused",
                   .text = fmt::format("{} of them cannot be obstacles: {}", refused.size(),
                                       refused.front().message)});
  }
}

void FallenRobots::narrow(std::span<const RobotId> robots, UtcTime now) {
  std::vector<SceneChange> changes;
  std::vector<RobotId> narrowed;
  for (const RobotId robot : robots) {
    const auto radius_m = body_radius_m(scene_.scene(), robot);
    if (!radius_m) continue;
    const std::optional<LastKnown> logged = logged_(robot);
    const std::optional<LastKnown>& known = newest_of(robot, logged);
    if (!known) continue;
    const Circle circle = circle_of_fallen(*known, now, mission_, robot);
    if (circle.radius_m >= *radius_m) continue;
    changes.emplace_back(AddBody{robot, circle});
    narrowed.push_back(robot);
  }
  if (changes.empty()) return;
  scene_.change_all(changes, now);
  log_.log(now, {.code = "body-narrowed",
                 .text = fmt::format("known better, by their logs on another host: {}",
                                     describe(narrowed))});
}

/// Robots that report again. The operator may have cleared the body of some already.
void FallenRobots::clear(std::span<const RobotId> robots, UtcTime now) {
  std::vector<SceneChange> changes;
  std::vector<RobotId> cleared;
  for (const RobotId robot : robots) {
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
