// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Robots whose processes die in a simulation, and are respawned.
#include <algorithm>
#include <csignal>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/mission/scene_bodies.hpp"
#include "swarm_launcher/supervision/fallen_body.hpp"
#include "swarm_sim/simulation.hpp"

namespace swarm::launcher {
namespace {

/// Draws of kills differ from all others of the same seed.
constexpr std::uint64_t kKillSeed = 0xD1E;

}  // namespace

/// Kills due by now, each with a seed of its own by its number. Fewer robots than requested is a
/// warning.
void Simulation::kill_due() {
  if (phase_ == MissionPhase::kReady) return;  // mission time has not begun
  for (; next_kill_ < options_.kills.size() && options_.kills[next_kill_].at_s <= mission_s();
       ++next_kill_) {
    const Kill& due = options_.kills[next_kill_];
    std::vector<Candidate> living;
    for (std::uint32_t i = 0; i < robots_.size(); ++i) {
      if (dead_[i] == 0) living.push_back({RobotId(i), robots_[i].loop.position_m()});
    }
    const std::vector<RobotId> chosen =
        choose(due, living, mix_seed(mix_seed(options_.seed, kKillSeed), next_kill_));
    for (const RobotId robot : chosen) kill(robot);
    const std::size_t wanted = due.robots.empty() ? due.count : due.robots.size();
    observer_.on_event(
        utc(now_), "launcher", chosen.size() < wanted, "kill",
        fmt::format("{} of {} robots killed: {}", chosen.size(), wanted, describe(chosen)));
  }
}

/// The robot neither ticks nor publishes any more; its driver stops the body when the last command
/// runs out.
void Simulation::kill(RobotId robot) {
  const std::uint32_t id = robot.value();
  for (std::vector<std::uint32_t>& members : slots_) std::erase(members, id);
  std::erase(respawned_, id);
  dead_[id] = 1;
  fallen_.push_back(id);
  supervisor_.on_exit(ProcessIndex(1 + id), {.code = 0, .signal = SIGKILL}, now_);
}

/// Moves the bodies of dead robots on and records them until they are at rest, where they stay.
void Simulation::coast_fallen() {
  std::erase_if(fallen_, [this](std::uint32_t id) {
    Robot& robot = robots_[id];
    const std::vector<robot_log::Step> last = recording_.last_steps(RobotId(id));
    const agent::Measurement body = robot.body.measure(now_);
    robot.loop.place_at(body.position_m);
    const Vec2 position_m = body.true_position_m.value_or(body.position_m);
    if (last.empty() || position_m == last.back().position_m) return true;
    recording_.step(RobotId(id), {.stamp = utc(now_),
                                  .position_m = position_m,
                                  .mode = static_cast<std::uint8_t>(robot.loop.mode())});
    return false;
  });
}

/// The robot's process is started again: it joins at the end of this period.
void Simulation::respawn(RobotId robot) {
  if (dead_[robot.value()] != 0) respawned_.push_back(robot.value());
}

/// Replaces the loops of respawned robots, as new processes would start: without state, at the
/// position of the body, and with a status report at once.
void Simulation::admit_respawned() {
  for (const std::uint32_t id : std::exchange(respawned_, {})) {
    Robot& robot = robots_[id];
    agent::AgentIdentity self = agent::agent_identity(mission_, RobotId(id));
    self.underway = true;
    count_states(robot);
    const Vec2 position_m = robot.loop.position_m();
    std::destroy_at(&robot.loop);  // one refers to the map and cannot be assigned
    std::construct_at(&robot.loop, world_, agent::agent_options(mission_, RobotId(id)), self);
    robot.loop.place_at(position_m);
    rngs_[id] = agent::agent_rng(RobotId(id), options_.seed);
    robot.received_until = now_;
    robot.plan_version = 0;
    dead_[id] = 0;
    std::erase(fallen_, id);
    std::vector<std::uint32_t>& members = slots_[slot_of(id)];
    members.insert(std::lower_bound(members.begin(), members.end(), id), id);
    has_updates_[id] = 1;
  }
}

/// Adds the bodies of dead and silent robots as obstacles, large enough for where
/// they may have come to rest by their last two steps.
void Simulation::add_bodies(std::span<const RobotId> robots) {
  std::vector<SceneChange> changes;
  for (const RobotId robot : robots) {
    const LastKnown placed{.position_m = robots_[robot.value()].loop.position_m(), .at_rest = true};
    LastKnown known = last_known(recording_.last_steps(robot), mission_).value_or(placed);
    known.is_last = true;
    changes.emplace_back(AddBody{robot, circle_of_fallen(known, utc(now_), mission_, robot)});
  }
  change_scene(changes);
  observer_.on_event(utc(now_), "launcher", true, "body-added",
                     fmt::format("robots not received any more stay where they are, as obstacles: "
                                 "{}",
                                 describe({robots.begin(), robots.end()})));
}

/// Removes the obstacles of robots that are received again.
void Simulation::clear_bodies(std::span<const RobotId> robots) {
  std::vector<SceneChange> changes;
  for (const RobotId robot : robots) {
    if (has_body(scene_, robot)) changes.emplace_back(ClearBody{robot});
  }
  if (changes.empty()) return;
  change_scene(changes);
  observer_.on_event(utc(now_), "launcher", false, "body-cleared",
                     fmt::format("received again, no obstacles any more: {}",
                                 describe({robots.begin(), robots.end()})));
}

}  // namespace swarm::launcher
