// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/phase.hpp"
#include "swarmflow/mission/scene.hpp"

/// Monitors: the interface through which a program observes a run or its recording.
namespace swarm::monitor {

/// A state update that a robot published for its neighbours: whenever their extrapolation of the
/// last one is off by more than link.send_error_m, and at least every link.send_interval_max_s.
struct ObservedState {
  RobotId robot;                     ///< the robot that published it
  std::uint32_t sequence = 0;        ///< counts the robot's state updates from 1; gaps are losses
  UtcTime stamp{};                   ///< when it held, by the robot's clock
  UtcTime received{};                ///< by this machine's clock; in a recording as `stamp`
  Vec2 position_m = Vec2::Zero();    ///< measured position, world frame [m]
  Vec2 velocity_mps = Vec2::Zero();  ///< velocity by which neighbours extrapolate it [m/s]
  RobotMode mode = RobotMode::kWaiting;  ///< what it was doing
};

/// A robot's status, published at link.status_hz and at changes of its mode.
struct ObservedStatus {
  RobotId robot;                         ///< the robot that published it
  UtcTime received{};                    ///< by this machine's clock
  Vec2 position_m = Vec2::Zero();        ///< measured position, world frame [m]
  RobotMode mode = RobotMode::kWaiting;  ///< what it is doing
  bool arrived = false;                  ///< whether it is at its final position
  double remaining_m = 0.0;              ///< length of its path that is left [m]
  double lag_s = 0.0;  ///< plan time by which it is behind its reference; negative if ahead [s]
  /// Gap to the nearest neighbour it knows, between surfaces; +∞ if it knows none [m].
  double nearest_gap_m = 0.0;
  std::uint32_t neighbours = 0;  ///< number of robots within its communication radius that it knows
  std::uint32_t ticks = 0,       ///< control periods since its start
      late_ticks = 0;            ///< those of them that began more than 20 ms late
};

/// A plan that the planner published.
struct ObservedPlan {
  const FlowPlan& flow;       ///< the flow; in a live run valid until the next on_plan()
  std::uint32_t version = 0;  ///< counts the plans of one planner process from 1
  /// By how much the plan breaks its own risk limit, where it does so most; 0 if it keeps it [m].
  double excess_m = 0.0;
  UtcTime received{};  ///< by this machine's clock; in a recording the epoch (0)
};

/// A heartbeat of the planner with the clocks of mission and plan, at timing.heartbeat_hz.
struct ObservedClock {
  MissionPhase phase = MissionPhase::kReady;  ///< phase of the mission
  double mission_time_s = 0.0;                ///< time since the start command; 0 before it [s]
  double plan_time_s = 0.0;                   ///< τ: the swarm is to form flow.mixture_at(τ) [s]
  double plan_rate = 0.0;                     ///< dτ/dt, in [0, 1]; 0 while the mission is paused
  UtcTime received{};                         ///< by this machine's clock
  UtcTime stamp{};                            ///< when it was published, by the planner's clock
};

/// An event of the run's log: something that happened once and that an operator may want to know.
struct ObservedEvent {
  UtcTime received{};    ///< by this machine's clock; in a recording the time of the event
  UtcTime stamp{};       ///< when it happened, by the clock of its source
  std::string source;    ///< "planner", "launcher" or a robot, as "robot-7"
  std::string severity;  ///< "info", "warning" or "error"
  std::string code;      ///< its kind, for programs, as "robot-fault"
  std::string text;      ///< one line for people
};

/// Receives what a run publishes, after the checks of the gate (message bounds, order, plausible
/// times): the interface of live views, metrics and monitors. Override what is needed; all defaults
/// do nothing.
///
/// Calls come from the thread that called observe_run() or observe_recording(), one at a time, in
/// the order in which the messages were received. Arguments are valid during the call. In a live
/// run a call that takes long delays the next ones, and best-effort messages may be lost meanwhile.
class Observer {
 public:
  /// Observers may be destroyed through this class.
  virtual ~Observer() = default;

  /// The mission of the run: called once, before all others.
  virtual void on_mission(const Mission&) {}
  /// A new plan.
  virtual void on_plan(const ObservedPlan&) {}
  /// A heartbeat with the clocks. Not called for a recording.
  virtual void on_clock(const ObservedClock&) {}
  /// The scene changed: an obstacle, the goal or the risk level. Not called for the scene of the
  /// mission file (version 0).
  virtual void on_scene(const Scene&) {}
  /// A robot's state update.
  virtual void on_state(const ObservedState&) {}
  /// A robot's status. Not called for a recording.
  virtual void on_status(const ObservedStatus&) {}
  /// An event.
  virtual void on_event(const ObservedEvent&) {}
};

/// Reports a run in flight to an observer; returns when `go_on()` returns false. Joins the run's
/// bus as a listener that is not counted among its participants and publishes nothing.
/// \param run_dir the directory that the launcher made for the run
/// \param observer receives the messages, from this thread
/// \param go_on polled about fifty times a second, from this thread
/// \return kBadInput if the directory has no readable mission, kEnvironment if its bus cannot be
///   joined
Result<void> observe_run(const std::filesystem::path& run_dir, Observer& observer,
                         const std::function<bool()>& go_on);

/// Reports a finished run to an observer: the mission, all plans, all scenes, then state updates
/// and events in the order of their times. States are the steps of the robot logs (true positions,
/// at the control rate), with the velocity to the next step. Clocks and statuses are not reported.
/// \param from a run directory, or a recording that has one's content
/// \param observer receives the content, from this thread
/// \return an error if the files cannot be read; nothing was reported then
Result<void> observe_recording(const std::filesystem::path& from, Observer& observer);

}  // namespace swarm::monitor
