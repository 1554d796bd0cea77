// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/robot/neighbour.hpp"
#include "swarmflow/robot/planned_density.hpp"
#include "swarmflow/robot/route.hpp"

namespace swarm::agent {

/// The inputs of a control method at one tick of the control loop. Valid during the call.
struct ControlView {
  SteadyTime now;                  ///< time of the tick
  Vec2 position_m = Vec2::Zero();  ///< measured position of the robot [m]
  /// Estimates of the other robots: at least those within PreparedControl::reach_m, as far as they
  /// are within the communication radius. In no particular order but that of `close`.
  std::span<const Neighbour> neighbours;
  /// The map at `now`, bodies of dead robots included. The same object at every tick, but its
  /// content is replaced when the scene changes: keep no references into it.
  const World& world;
  /// The first of `neighbours`: those near enough for the safety filter or for contact forces.
  std::span<const Neighbour> close{};
  /// Time and rate of the clock of the plan in force; empty until a heartbeat for that plan was
  /// received. While the planner is silent, τ does not advance.
  std::optional<PlanTime> plan_time{};
  /// The plan's density at that time; null unless PreparedControl::reads_density is set and a plan
  /// and its clock are known.
  const PlannedDensity* planned_density = nullptr;
};

/// The reference of a robot that keeps the plan's times, for the robot log and the audit.
struct TimeTracking {
  double plan_time_s = 0.0;         ///< τ [s]
  Vec2 reference_m = Vec2::Zero();  ///< x_ref(τ): position at which the plan has this robot [m]
};

/// Turns a robot's route through the plan into a desired velocity: one class per method of the
/// papers, one object per robot. The extension point of `control.method` (control_registry.hpp).
///
/// The desired velocity passes through the safety filter, which commands the nearest velocity that
/// keeps the robot clear of neighbours, obstacles and bounds: a method need not avoid collisions,
/// it only moves better if it does.
///
/// Calls, all from the thread of the control loop at `control.rate_hz`:
///
///   set_goals(plan), begin(route, world)     at the first plan and at each one that differs
///   has_arrived(view)                        at every tick with a route, once the mission started
///   wish(view, …) or hold(view)              at every tick, unless the robot is stopped
///   goal(), tracking(), lag_s(), …           after these, for status and robot log
///
/// hold() may come before begin(), while the robot waits for a plan. A method must be a function of
/// its inputs and the generator alone, so that a run can be repeated; it should not allocate after
/// begin(), and a tick of all robots of a process must fit into a control period: commands run out
/// after two periods (event `tick-overrun`). An exception, or a result that is not finite, stops
/// the robot for good (mode kStopped, event `robot-fault`) and the method is not called again.
/// Methods of different robots must not share data that changes: a simulation runs them in
/// parallel.
class ControlMethod {
 public:
  /// Methods are owned by a ControlSlot.
  virtual ~ControlMethod() = default;

  /// The plan that the route of the following begin() is taken from, for methods that need all of
  /// its goals. By default ignored. `plan` is valid during the call.
  virtual void set_goals(const FlowPlan& /*plan*/) {}

  /// Starts a route, the first or another one; the robot is at its begin or near it. May allocate.
  /// \param route the robot's path, schedule and goal; valid during the call
  /// \param world the map, the object that ControlView::world refers to later
  virtual void begin(const Route& route, const World& world) = 0;

  /// Whether the robot has reached its final position. May change from true to false again, when
  /// others push the robot away. Called once a tick, before wish() or hold().
  virtual bool has_arrived(const ControlView& view) = 0;

  /// Desired velocity of a robot under way or arrived, world frame [m/s]. Its norm should not
  /// exceed the robot's largest speed; the safety filter limits it.
  /// \param view inputs of this tick
  /// \param arrived the answer of has_arrived() at this tick; an arrived robot keeps its position
  /// \param rng the robot's own generator, the only source of randomness
  virtual Vec2 desired_velocity(const ControlView& view, bool arrived, Rng& rng) = 0;

  /// Desired velocity of a robot that is held (no plan yet, mission paused, planner silent): only
  /// avoidance of neighbours and obstacles, zero if nothing is near [m/s]. Time spent here must not
  /// count as being stuck.
  virtual Vec2 hold(const ControlView& view) = 0;

  /// The goal that the robot is at or goes to, as an index into FlowPlan::sinks() of the last plan.
  /// \param position_m the robot's present position [m]
  /// \pre begin() was called
  virtual std::uint32_t goal(const Vec2& position_m) const = 0;

  /// The reference of the last desired velocity; empty for a method that does not keep the plan's
  /// times, and for a tick without a plan's clock. By default empty.
  virtual std::optional<TimeTracking> tracking() const { return std::nullopt; }

  /// Plan time by which the robot is behind its reference [s]; negative if it is ahead. The planner
  /// slows the plan's clock by a quantile of it over the swarm (`plan_clock`). By default 0.
  virtual double lag_s() const { return 0.0; }

  /// Length of the path that is left [m]; for status and progress, ≥ 0.
  virtual double remaining_m() const = 0;

  /// Number of times the method has started to escape from a deadlock; for the log, never
  /// decreases.
  virtual std::uint32_t escapes() const = 0;
};

}  // namespace swarm::agent
