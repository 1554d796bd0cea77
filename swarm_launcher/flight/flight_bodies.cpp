// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Robots that are not received any more: their bodies become obstacles for the others.
#include <fmt/format.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_launcher/flight/flight.hpp"

namespace swarm::launcher {

/// The newest known position of a robot. Its log, on this host only, has its last control period;
/// its last status is up to a second old.
std::optional<LastKnown> Flight::last_known_of(RobotId robot) const {
  const std::optional<LastKnown>& reported = reported_.at(robot.value());
  const auto steps = robot_log::last_steps(robot_log::file_of(run_->dir(), robot));
  if (!steps) return reported;
  const auto logged = last_known(*steps, run_->options().mission);
  return !logged || (reported && reported->at > logged->at) ? reported : logged;
}

// All bodies in one change of the scene, since each change causes a new plan.
void Flight::add_bodies(std::span<const RobotId> robots) {
  const UtcTime now = utc_now();
  std::vector<SceneChange> changes;
  std::vector<RobotId> added, unknown;
  for (const RobotId robot : robots) {
    const auto known = last_known_of(robot);
    (known ? added : unknown).push_back(robot);
    if (!known) continue;
    changes.emplace_back(
        AddBody{robot, circle_of_fallen(*known, now, run_->options().mission, robot)});
  }
  const std::vector<Error> refused = run_->scene().change_all(changes, now);
  if (!added.empty()) {
    log({.warning = true,
         .code = "body-added",
         .text = fmt::format("robots not received any more stay where they are, as obstacles: {}",
                             describe(added))});
  }
  if (!unknown.empty()) {
    log({.warning = true,
         .code = "body-unknown",
         .text = fmt::format("robots at unknown positions, others may touch them: {}",
                             describe(unknown))});
  }
  if (!refused.empty()) {
    log({.warning = true,
         .code = "body-refused",
         .text = fmt::format("{} of them cannot be obstacles: {}", refused.size(),
                             refused.front().message)});
  }
}

/// Robots that report again. The operator may have cleared the body of some already.
void Flight::clear_bodies(std::span<const RobotId> robots) {
  std::vector<SceneChange> changes;
  std::vector<RobotId> cleared;
  for (const RobotId robot : robots) {
    if (!has_body(run_->scene().scene(), robot)) continue;
    changes.emplace_back(ClearBody{robot});
    cleared.push_back(robot);
  }
  if (changes.empty()) return;
  run_->scene().change_all(changes, utc_now());
  log({.code = "body-cleared",
       .text = fmt::format("received again, no obstacles any more: {}", describe(cleared))});
}

}  // namespace swarm::launcher
