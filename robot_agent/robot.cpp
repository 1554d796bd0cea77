// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/robot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace swarm::agent {
namespace {

constexpr Duration kLate = std::chrono::milliseconds(20);
constexpr std::uint32_t kTicksPerBelief = 5;

std::int64_t to_us(Duration d) {
  return std::chrono::duration_cast<std::chrono::microseconds>(d).count();
}

std::int64_t to_ns(UtcTime t) { return t.time_since_epoch().count(); }

}  // namespace

Robot::Robot(const World& world, Shared<AgentOptions> options, const AgentIdentity& self, Rng rng,
             std::unique_ptr<Driver> driver, blackbox::Writer box)
    : id_(self.robot),
      agent_(world, std::move(options), self),
      driver_(std::move(driver)),
      box_(std::move(box)),
      rng_(rng) {}

void Robot::step(const Tick& tick, const Inbox& inbox, const NewPlan* new_plan,
                 Histogram& state_age) {
  const Measurement body = driver_->measure(tick.now);
  position_m_ = body.position_m;
  const Vec2 true_position_m = body.true_position_m.value_or(body.position_m);
  const std::uint8_t goal =
      agent_.has_route() ? static_cast<std::uint8_t>(std::min(agent_.goal(position_m_), 254U))
                         : blackbox::Step::kNoGoal;
  if (body.command_expired) {  // the body stopped between two ticks: the path has a point there
    box_.append(blackbox::Step{.stamp = tick.utc_now - (tick.now - body.expired_at),
                               .position_m = body.expired_position_m,
                               .mode = static_cast<std::uint8_t>(output_.mode),
                               .goal = goal});
  }
  if (new_plan != nullptr) {
    std::optional<double> plan_time_s;
    if (tick.plan_time) plan_time_s = tick.plan_time->plan_time_s;
    agent_.accept_plan(new_plan->flow, position_m_, new_plan->entry_of(id_), plan_time_s);
    note(tick.utc_now, "plan", "took plan version " + std::to_string(inbox.plan_version()));
  }
  inbox.heard().visit_near(position_m_, [&](const HeardState& state) {
    if (state.report.robot == id_) return;  // our own echo
    if (agent_.hear(state.report, position_m_, state.age) == NeighbourTable::Outcome::kTaken) {
      state_age.add(to_us(state.age));
      ++heard_;
    }
  });
  const RobotMode before = output_.mode;
  output_ = agent_.tick({.now = tick.now,
                         .position_m = position_m_,
                         .phase = inbox.mission().phase(),
                         .planner_alive = inbox.mission().planner_alive(tick.now),
                         .velocity_mps = body.velocity_mps,
                         .plan_time = tick.plan_time,
                         .planned_density = tick.planned_density},
                        rng_);
  mode_changed_ = !stepped_ || output_.mode != before;
  stepped_ = true;
  driver_->command(tick.now, output_.velocity_mps, 2 * tick.period);

  ++ticks_;
  if (tick.lateness > kLate) ++late_ticks_;
  const TimeTracking tracking = output_.tracking.value_or(TimeTracking{});
  box_.append(blackbox::Step{
      .stamp = tick.utc_now,
      .position_m = true_position_m,
      .velocity_mps = output_.velocity_mps,
      .lateness_us =
          static_cast<std::int32_t>(std::min<std::int64_t>(to_us(tick.lateness), INT32_MAX)),
      .mode = static_cast<std::uint8_t>(output_.mode),
      .goal = agent_.has_route()
                  ? static_cast<std::uint8_t>(std::min(agent_.goal(position_m_), 254U))
                  : blackbox::Step::kNoGoal,
      .neighbours = output_.neighbours,
      .plan_version = output_.tracking ? inbox.plan_version() : 0,
      .plan_time_s = static_cast<float>(tracking.plan_time_s),
      .reference_x_m = static_cast<float>(tracking.reference_m.x()),
      .reference_y_m = static_cast<float>(tracking.reference_m.y())});
  if (ticks_ % kTicksPerBelief == 0 && !output_.believed.empty()) {
    const auto& one = output_.believed[ticks_ / kTicksPerBelief % output_.believed.size()];
    box_.append(blackbox::Belief{
        .stamp = tick.utc_now, .neighbour = one.robot, .position_m = one.position_m});
  }
  if (mode_changed_) {
    note(tick.utc_now, "mode", std::string(to_string(output_.mode)),
         output_.mode == RobotMode::kStopped ? inbox.stop_stamp_utc_ns() : 0);
  }

  to_say_.reset();
  if (output_.say) {
    to_say_ = link::RobotStateMessage{.robot_id = id_.value(),
                                      .sequence_number = ++sequence_,
                                      .stamp_utc_ns = to_ns(tick.utc_now),
                                      .x_m = position_m_.x(),
                                      .y_m = position_m_.y(),
                                      .vx_mps = output_.told_mps.x(),
                                      .vy_mps = output_.told_mps.y(),
                                      .mode = output_.mode};
    echo_.said(*to_say_);
    ++said_;
  }
}

link::RobotStatusMessage Robot::status() const {
  return {.robot_id = id_.value(),
          .mode = output_.mode,
          .arrived = output_.mode == RobotMode::kArrived,
          .settled = output_.settled,
          .x_m = position_m_.x(),
          .y_m = position_m_.y(),
          .remaining_m = output_.remaining_m,
          .lag_s = agent_.lag_s(),
          .nearest_gap_m = std::isfinite(output_.nearest_gap_m) ? output_.nearest_gap_m : 1e9,
          .neighbours_heard = output_.neighbours,
          .ticks = ticks_,
          .late_ticks = late_ticks_,
          .states_sent = said_,
          .states_received = heard_};
}

void Robot::note(UtcTime utc_now, const std::string& code, const std::string& text,
                 std::int64_t caused_utc_ns) {
  box_.append(blackbox::Note{
      .stamp = utc_now, .caused = UtcTime(Duration(caused_utc_ns)), .code = code, .text = text});
}

}  // namespace swarm::agent
