// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/loop/robot_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "robot_agent/safety/fault_text.hpp"
#include "swarm_core/metrics/late_ticks.hpp"

namespace swarm::agent {
namespace {

/// Ticks between two recorded estimates of a neighbour, per robot.
constexpr std::uint32_t kTicksPerEstimate = 10;

// Ticks between two queries of the driver's health.
constexpr std::uint32_t kTicksPerHealth = 10;

std::int32_t to_us(Duration d) {
  return static_cast<std::int32_t>(
      std::min<std::int64_t>(d / std::chrono::microseconds(1), INT32_MAX));
}

}  // namespace

/// Index of the goal as recorded.
[[gnu::hot]] std::uint8_t RobotLoop::goal() const {
  if (!agent_.has_route()) return robot_log::Step::kNoGoal;
  return static_cast<std::uint8_t>(
      std::min(agent_.goal(position_m_), robot_log::Step::kNoGoal - 1U));
}

/// Measures and checks the body's position, and accepts a new plan from there.
[[gnu::hot]] Measurement RobotLoop::measure(const RobotTick& tick, const RobotParts& parts) {
  const Measurement body = parts.driver.measure(tick.now);
  pose_ = pose_check_.check(body, tick.now);
  has_position_ = has_position_ || pose_.is_valid;
  if (pose_.is_valid || (!has_position_ && body.position_m.allFinite())) {
    position_m_ = pose_.position_m;
  }
  if (body.command_expired) {  // the body stopped between two ticks: the log gets a step there
    parts.log.append(robot_log::Step{.stamp = tick.utc_now - (tick.now - body.expired_at),
                                     .position_m = body.expired_position_m,
                                     .mode = static_cast<std::uint8_t>(output_.mode),
                                     .goal = goal()});
  }
  if (tick.new_plan != nullptr) {
    std::optional<double> plan_time_s;
    if (tick.plan_time) plan_time_s = tick.plan_time->plan_time_s;
    const OfferedPlan& plan = *tick.new_plan;
    const bool changed = agent_.accept_plan(plan.flow, position_m_, plan.entry, plan_time_s);
    if (changed || !plan.again) {
      const std::string what =
          plan.again ? "found a path around a body in plan version " : "took plan version ";
      parts.log.append(robot_log::Note{
          .stamp = tick.utc_now, .code = "plan", .text = what + std::to_string(tick.plan_version)});
    }
  }
  return body;
}

/// Decides and commands. The command goes to the driver before the step is logged, so that the disk
/// does not delay it.
[[gnu::hot]] void RobotLoop::decide(const RobotTick& tick, const RobotParts& parts,
                                    const Measurement& body) {
  const RobotMode mode_before = output_.mode;
  const bool was_settled = output_.settled;
  output_ = pose_.is_valid ? agent_.tick({.now = tick.now,
                                          .position_m = position_m_,
                                          .phase = tick.phase,
                                          .planner_alive = tick.planner_alive,
                                          .may_move = tick.may_move,
                                          .velocity_mps = pose_.velocity_mps,
                                          .plan_time = tick.plan_time,
                                          .planned_density = tick.planned_density,
                                          .silent = tick.silent},
                                         parts.rng)
                           : without_position(tick.phase);
  // Before the command: the last step of a process that is killed in between has its new velocity.
  late_ticks_ += late_ticks(tick.lateness, tick.period);
  if (has_position_ || body.true_position_m) {  // otherwise the robot is not known to be anywhere
    log_step(tick, parts.log, body.true_position_m.value_or(position_m_));
  }
  if (output_.mode == RobotMode::kStopped) {
    parts.driver.stop(tick.now, StopKind::kHold);
  } else {
    // Longer than a period, as a tick may be late; limited, as a dead process must not drive on.
    parts.driver.command(tick.now, output_.velocity_mps, robot_log::command_lifetime(tick.period));
  }
  const bool is_well = pose_.is_valid && fault_.empty() && agent_.control_fault().empty();
  if (!is_well || ticks_ % kTicksPerHealth == 0) update_fault(parts.driver);
  const bool mode_changed = output_.mode != mode_before;
  has_updates_ = mode_changed || (output_.settled && !was_settled);

  const bool is_first = ticks_++ == 0;
  if (!mode_changed && !is_first) return;
  parts.log.append(
      robot_log::Note{.stamp = tick.utc_now,
                      .caused = output_.mode == RobotMode::kStopped ? tick.stop_sent : UtcTime{},
                      .code = "mode",
                      .text = std::string(to_string(output_.mode))});
}

/// A robot that does not know where it is brakes, and publishes the last position that it had at
/// each tick: its silence would be read as a robot that is well somewhere else. It obeys an
/// emergency stop all the same.
AgentOutput RobotLoop::without_position(MissionPhase phase) const {
  AgentOutput out;
  out.mode = phase == MissionPhase::kStopped ? RobotMode::kStopped
             : output_.mode == RobotMode::kStopped || output_.mode == RobotMode::kWaiting
                 ? output_.mode
                 : RobotMode::kHolding;
  out.nearest_gap_m = std::numeric_limits<double>::infinity();
  out.send = has_position_;
  return out;
}

/// A fault of the control method is final; that of a missing position ends with the position; the
/// driver's health is read every tenth tick.
void RobotLoop::update_fault(const Driver& driver) {
  if (!agent_.control_fault().empty()) {
    if (fault_.empty()) fault_ = agent_.control_fault();
  } else if (!pose_.is_valid) {
    if (!std::exchange(is_lost_, true)) {
      const std::string text = fault_text(driver.health().text);
      fault_ = pose_.why + (text.empty() ? "" : ": " + text) + "; the robot holds";
    }
  } else if (is_lost_) {
    fault_.clear();
    is_lost_ = false;
  } else if (ticks_ % kTicksPerHealth == 0) {
    const DriverHealth health = driver.health();
    fault_ = health.level == DriverHealth::Level::kGood ? std::string() : fault_text(health.text);
  }
}

/// Records the true position where the driver knows it (simulated bodies): the audit measures gaps
/// between bodies, not between measurements.
[[gnu::hot]] void RobotLoop::log_step(const RobotTick& tick, RobotLog& log,
                                      const Vec2& true_position_m) const {
  const TimeTracking tracking = output_.tracking.value_or(TimeTracking{});
  log.append(robot_log::Step{.stamp = tick.utc_now,
                             .position_m = true_position_m,
                             .velocity_mps = output_.velocity_mps,
                             .lateness_us = to_us(tick.lateness),
                             .mode = static_cast<std::uint8_t>(output_.mode),
                             .goal = goal(),
                             .neighbours = output_.neighbours,
                             .plan_version = output_.tracking ? tick.plan_version : 0,
                             .plan_time_s = static_cast<float>(tracking.plan_time_s),
                             .reference_x_m = static_cast<float>(tracking.reference_m.x()),
                             .reference_y_m = static_cast<float>(tracking.reference_m.y())});
  const auto tick_number = ticks_ + 1;
  if (tick_number % kTicksPerEstimate != 0 || output_.estimated.empty()) return;
  // Each neighbour within reach in turn: the error of estimates is a sample of all pairs.
  const Neighbour& one =
      output_.estimated[tick_number / kTicksPerEstimate % output_.estimated.size()];
  if (one.is_silent) return;  // a disc in which it may be, not an estimate of where it is
  log.append(robot_log::Estimate{
      .stamp = tick.utc_now, .neighbour = one.robot, .position_m = one.position_m});
}

/// Sequence numbers begin at 1 and grow by 1 per state, so that receivers can count losses.
link::RobotStateMessage RobotLoop::next_state(UtcTime utc_now) {
  return {.robot_id = id_.value(),
          .sequence_number = ++states_sent_,
          .stamp_utc_ns = utc_now.time_since_epoch().count(),
          .x_m = position_m_.x(),
          .y_m = position_m_.y(),
          .vx_mps = output_.reported_mps.x(),
          .vy_mps = output_.reported_mps.y(),
          .mode = output_.mode};
}

link::RobotStatusMessage RobotLoop::status() const {
  constexpr double kNoNeighbourGap_m = 1e9;  // finite, as everything on the bus
  return {.robot_id = id_.value(),
          .mode = output_.mode,
          .arrived = output_.mode == RobotMode::kArrived,
          .settled = output_.settled,
          .x_m = position_m_.x(),
          .y_m = position_m_.y(),
          .remaining_m = output_.remaining_m,
          .lag_s = agent_.lag_s(),
          .nearest_gap_m =
              std::isfinite(output_.nearest_gap_m) ? output_.nearest_gap_m : kNoNeighbourGap_m,
          .neighbours_heard = output_.neighbours,
          .ticks = ticks_,
          .late_ticks = late_ticks_,
          .states_sent = states_sent_,
          .states_received = states_received_};
}

}  // namespace swarm::agent
