// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "swarmflow/robot/planned_density.hpp"
#include "swarmflow/robot/route.hpp"
#include "swarmflow/robot/neighbour.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::agent {

/// What a robot knows at a tick.
struct ControlView {
  SteadyTime now;
  Vec2 position_m = Vec2::Zero();
  std::span<const Neighbour> neighbours;
  const World& world;
  std::span<const Neighbour> close{};   ///< the first of the neighbours: Neighbourhood::close
  std::optional<PlanTime> plan_time{};  ///< of the plan's clock; empty: there is none
  const PlannedDensity* planned_density = nullptr;  ///< at that time; null: not asked for
};

/// Where a robot is in time, of one that keeps the plan's times.
struct TimeTracking {
  double plan_time_s = 0.0;         ///< τ
  Vec2 reference_m = Vec2::Zero();  ///< x_ref(τ): where the plan has this robot
};

/// How a robot turns its way through the flow into a velocity: one class per method of the papers.
/// What it asks for is a wish; the safety filter below it decides. A method is a pure function of
/// what it is shown and its generator, and does not allocate after begin().
class ControlMethod {
 public:
  virtual ~ControlMethod() = default;

  /// The plan that the robot's way is taken from, told before begin().
  virtual void see_goals(const FlowPlan& /*plan*/) {}

  /// The robot has a way, or another one.
  virtual void begin(const Route& route, const World& world) = 0;

  /// Whether the robot is where it should end. Asked once a tick while there is a way.
  virtual bool has_arrived(const ControlView& view) = 0;

  /// Velocity wished [m/s]. An arrived robot only keeps its place.
  virtual Vec2 wish(const ControlView& view, bool arrived, Rng& rng) = 0;

  /// Velocity wished while the robot is held: avoidance alone. Time held is no time stuck.
  virtual Vec2 hold(const ControlView& view) = 0;

  /// Index of the goal (sink of the plan) the robot is at or goes to. \pre begin() was called
  virtual std::uint32_t goal(const Vec2& position_m) const = 0;

  /// As of the last desired velocity; empty for a method, or a plan, without times.
  virtual std::optional<TimeTracking> tracking() const { return std::nullopt; }

  /// Plan time by which it is behind its reference, negative if ahead of it; 0 without times.
  virtual double lag_s() const { return 0.0; }

  virtual double remaining_m() const = 0;     ///< of the own way
  virtual std::uint32_t escapes() const = 0;  ///< how often it freed itself from a deadlock
};

}  // namespace swarm::agent
