// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <utility>

#include "robot_agent/inbox.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::agent {

/// Hands the newest plan to the robots of a process, once. A robot that was restarted in mid-flight
/// finds its position in the plan by the plan's time, too: its process holds a plan back until the
/// first heartbeat with that time arrives, for a second at most.
class PlanIntake {
 public:
  explicit PlanIntake(bool waits_for_clock) : waits_for_clock_(waits_for_clock) {}

  void receive(std::optional<NewPlan> plan, SteadyTime now) {
    if (!plan) return;
    waiting_ = std::move(plan);
    since_ = now;
  }

  /// The plan to follow from now on, if there is a new one.
  std::optional<NewPlan> take(SteadyTime now, bool clock_is_known) {
    const bool waits = waits_for_clock_ && !clock_is_known && now - since_ < kClockTimeout;
    return waits ? std::nullopt : std::exchange(waiting_, std::nullopt);
  }

 private:
  static constexpr Duration kClockTimeout = std::chrono::seconds(1);

  bool waits_for_clock_;
  std::optional<NewPlan> waiting_;
  SteadyTime since_;
};

}  // namespace swarm::agent
