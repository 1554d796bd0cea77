// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "robot_agent/check/driver_check.hpp"

namespace swarm::agent {

/// Calls a driver as a control loop does, tick by tick, and keeps what it measured.
class DriverTrial {
 public:
  DriverTrial(Driver& driver, const DriverCheckOptions& options, CheckClock& clock)
      : driver_(driver), options_(options), clock_(clock), next_(clock.now()) {}

  /// One tick: waits for its time, measures, then calls `act`.
  const Measurement& tick(const std::function<void(SteadyTime)>& act);
  const Measurement& tick() {
    return tick([](SteadyTime) {});
  }
  /// Ticks with a command, for a time.
  void drive(const Vec2& velocity_mps, Duration span);
  /// Ticks with stop(kind), for a time.
  void stop(StopKind kind, Duration span);
  /// Ticks without a command, for a time or until a condition holds; whether it held.
  bool wait(Duration span, const std::function<bool(const Measurement&)>& until);
  void idle(Duration span) {
    wait(span, [](const Measurement&) { return false; });
  }
  /// Time passes without any call, as in a frozen process.
  void freeze(Duration span);

  /// As measured last, or truly where the driver knows it.
  Vec2 position_m() const { return newest_.true_position_m.value_or(newest_.position_m); }
  const DriverHealth& health() const { return health_; }
  /// From here on the robot must stay in its room about this position.
  void enter_room() { middle_m_ = position_m(); }
  /// Why the check must end; then no command is given any more. Empty while it may go on.
  const std::string& ended() const { return ended_; }
  /// First thing that is wrong with a measurement or the health; empty if nothing.
  const std::string& nonsense() const { return nonsense_; }
  /// Calls that took longer than half a period, and all.
  int slow_calls() const { return slow_calls_; }
  int calls() const { return calls_; }

 private:
  template <class Call>
  void timed(Call call);
  void look_at(const Measurement& m);
  void look_at(const DriverHealth& health);
  bool must_end();

  Driver& driver_;
  const DriverCheckOptions& options_;
  CheckClock& clock_;
  SteadyTime next_;
  Measurement newest_;
  DriverHealth health_;
  std::optional<Vec2> middle_m_;
  std::string ended_;
  std::string nonsense_;
  int ticks_ = 0;
  int slow_calls_ = 0;
  int calls_ = 0;
};

}  // namespace swarm::agent
