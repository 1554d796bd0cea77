// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <utility>

#include "robot_agent/inbox.hpp"
#include "robot_agent/loop/robot_loop.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::agent {

/// A plan for the robots of a process.
struct TakenPlan {
  NewPlan plan;
  bool again = false;  ///< it was handed on before
};

/// Hands the newest plan to the robots of a process, once. A robot that was restarted in mid-flight
/// finds its position in the plan by the plan's time, too: its process holds a plan back until the
/// first heartbeat with that time arrives, for a second at most.
///
/// A new scene may put the body of a dead robot on the path of another. If no new plan follows it
/// soon, as no plan can be made, the newest one is handed on again, for the robots to find a path
/// around that body.
class PlanIntake {
 public:
  explicit PlanIntake(bool waits_for_clock) : waits_for_clock_(waits_for_clock) {}

  void receive(std::optional<NewPlan> plan, SteadyTime now) {
    if (!plan) return;
    waiting_ = std::move(plan);
    since_ = now;
    repeat_at_.reset();
  }

  void on_scene(SteadyTime now) { repeat_at_ = now + kReplanTimeout; }

  /// The plan to follow from now on, if there is a new one or it is time to repeat the newest.
  std::optional<TakenPlan> take(SteadyTime now, bool clock_is_known) {
    if (waiting_) {
      if (waits_for_clock_ && !clock_is_known && now - since_ < kClockTimeout) return std::nullopt;
      newest_ = waiting_->flow;
      return TakenPlan{*std::exchange(waiting_, std::nullopt)};
    }
    if (newest_.empty() || !repeat_at_ || now < *repeat_at_) return std::nullopt;
    repeat_at_.reset();
    return TakenPlan{{newest_, {}}, true};
  }

  /// The plan handed on last; empty before the first.
  const FlowPlan& newest() const { return newest_; }

 private:
  static constexpr Duration kClockTimeout = std::chrono::seconds(1);

  bool waits_for_clock_;
  std::optional<NewPlan> waiting_;
  SteadyTime since_;
  FlowPlan newest_;
  std::optional<SteadyTime> repeat_at_;
};

}  // namespace swarm::agent
