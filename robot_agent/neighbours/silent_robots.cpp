// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbours/silent_robots.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
#include "swarmflow/mission/body_limits.hpp"

namespace swarm::agent {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// After this time, a robot whose body is an obstacle has stood for long, or its process was ended.
constexpr Duration kDrivesOnFor = std::chrono::seconds(15);

/// The longest time that a body of the mission takes to reach a commanded velocity.
double largest_lag_s(const RobotsSpec& robots) {
  double largest = body_lag_s(robots);
  for (const RobotGroupSpec& group : robots.groups) largest = std::max(largest, body_lag_s(group));
  return largest;
}

}  // namespace

SilentRobots::SilentRobots(const SilenceOptions& options)
    : options_(options), index_of_(options.robots, kNone) {
  SWARM_ASSERT(options.frozen_body_radius_m.size() == options.robots);
  received_.reserve(options.robots);
  silent_.reserve(options.robots);
}

/// The entry of a robot; a new one has this state.
SilentRobots::Received& SilentRobots::received(const State& state) {
  std::uint32_t& index = index_of_[state.robot.value()];
  if (index == kNone) {
    index = static_cast<std::uint32_t>(received_.size());
    received_.push_back(
        {.last = state, .missed_since = state.as_of, .is_reported = true, .is_status = true});
  }
  return received_[index];
}

void SilentRobots::on_state(const State& state) {
  if (!covers(state.robot)) return;
  Received& robot = received(state);
  if (robot.is_reported ? robot.last.as_of <= state.as_of : robot.last.as_of < state.as_of) {
    robot = {.last = state, .missed_since = state.as_of};
  }
}

/// A later position makes a disc smaller and does not end it: the robot is still not received here.
void SilentRobots::on_beat(const link::LauncherBeat& beat, SteadyTime sent) {
  for (const link::LateRobot& late : beat.late()) {
    const State state{.robot = RobotId(late.robot),
                      .as_of = sent - std::chrono::milliseconds(late.age_ms),
                      .position_m = {late.x_m, late.y_m}};
    if (!covers(state.robot)) continue;
    Received& robot = received(state);
    if (robot.last.as_of >= state.as_of) continue;
    robot.last = state;
    robot.missed_since = state.as_of;
    robot.has_left = false;
    robot.is_status = true;
  }
}

/// Whether nothing speaks for the robot being near its last position: the launcher has received it
/// since, and here only the launcher had reported it, or it has left the cells that are received;
/// or the launcher has received it for long.
bool SilentRobots::is_elsewhere(const Received& robot, SteadyTime now,
                                const Whereabouts& whereabouts) const {
  const auto& [id, as_of, position_m] = robot.last;
  if (robot.is_reported && !whereabouts.may_be_late(id, now)) return true;
  if (robot.has_left && !robot.is_silent && whereabouts.is_alive(id, as_of, now)) return true;
  return now - as_of > options_.expected_silence && whereabouts.is_well(id, as_of, now);
}

/// Robots that are elsewhere are forgotten; the others close ranks, in their order. A robot whose
/// body is an obstacle is kept: the launcher may clear the body as soon as it receives the robot,
/// before the robot's next state arrives here, or may know little of where the body is.
void SilentRobots::update(SteadyTime now, const Whereabouts& whereabouts,
                          const ReceivesAt& receives_at) {
  silent_.clear();
  std::uint32_t kept = 0;
  for (Received& robot : received_) {
    const State& state = robot.last;
    if (receives_at && !receives_at(state.position_m)) {
      robot.missed_since = now;
      robot.has_left = true;
    }
    if (is_elsewhere(robot, now, whereabouts)) {
      index_of_[state.robot.value()] = kNone;
      continue;
    }
    robot.is_silent |= now - robot.missed_since > options_.expected_silence;
    const Duration age = now - state.as_of;
    const std::optional<double> body_m = whereabouts.obstacle_radius_m(state.robot);
    const bool is_there =
        body_m &&
        (*body_m <= options_.frozen_body_radius_m[state.robot.value()] || age > kDrivesOnFor);
    if (robot.is_silent && !is_there) silent_.push_back(possible_positions(robot, age));
    index_of_[state.robot.value()] = kept;
    received_[kept++] = robot;
  }
  received_.resize(kept);
}

/// Between two statuses a robot drives for longer than between two states before it can have been
/// cut off.
SilentRobot SilentRobots::possible_positions(const Received& robot, Duration age) const {
  const State& state = robot.last;
  const Fleet::Body& body = options_.fleet.of(state.robot);
  const Duration cut_off_after = robot.is_status
                                     ? std::max(options_.expected_silence, options_.expected_status)
                                     : options_.expected_silence;
  const Duration stands_after = cut_off_after + options_.dead_man;
  return {.robot = state.robot,
          .centre_m = state.position_m,
          .radius_m = body.radius_m + body.speed_max_mps * to_seconds(std::min(age, stands_after)),
          .growth_mps = age < stands_after ? body.speed_max_mps : 0.0};
}

SilenceOptions silence_options(const Mission& mission, RobotId first, std::uint32_t count) {
  const Duration period = from_seconds(1.0 / mission.control.rate_hz);
  const Duration silence = from_seconds(mission.link.send_interval_max_s) + 2 * period;
  std::vector<double> frozen_m;
  for (std::uint32_t i = 0; i < mission.robots.count; ++i)
    frozen_m.push_back(frozen_body_radius_m(mission, RobotId(i)));
  return {
      .fleet = Fleet(mission.robots),
      .robots = mission.robots.count,
      .first_own = first.value(),
      .own = count,
      .frozen_body_radius_m = std::move(frozen_m),
      .expected_silence = silence,
      .expected_status = from_seconds(1.0 / mission.link.status_hz) + period,
      .dead_man = from_seconds(mission.timing.planner_silence_s + largest_lag_s(mission.robots)) +
                  silence + 2 * period};
}

}  // namespace swarm::agent
