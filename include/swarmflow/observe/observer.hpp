// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/phase.hpp"
#include "swarmflow/mission/scene.hpp"
#include "swarmflow/core/flow_plan.hpp"

namespace swarm::monitor {

/// A state that a robot published.
struct ObservedState {
  RobotId robot;
  std::uint32_t sequence = 0;  ///< counts the robot's states from 1
  UtcTime stamp{};             ///< by the robot's clock
  UtcTime received{};          ///< by ours; of a recording as the stamp
  Vec2 position_m = Vec2::Zero();
  Vec2 velocity_mps = Vec2::Zero();
  RobotMode mode = RobotMode::kWaiting;
};

/// A robot's status, published about once a second and at changes of its mode.
struct ObservedStatus {
  RobotId robot;
  UtcTime received{};
  Vec2 position_m = Vec2::Zero();
  RobotMode mode = RobotMode::kWaiting;
  bool arrived = false;
  double remaining_m = 0.0;    ///< of its path
  double lag_s = 0.0;          ///< plan time by which it is behind its reference
  double nearest_gap_m = 0.0;  ///< to the nearest neighbour, surface to surface; +∞ if none
  std::uint32_t neighbours = 0;
  std::uint32_t ticks = 0, late_ticks = 0;
};

/// A plan. The flow lives until the next one is reported.
struct ObservedPlan {
  const FlowPlan& flow;
  std::uint32_t version = 0;
  double excess_m = 0.0;  ///< by how much it breaks its own constraints
  UtcTime received{};
};

/// The mission's and the plan's clock, published several times a second.
struct ObservedClock {
  MissionPhase phase = MissionPhase::kReady;
  double mission_time_s = 0.0;
  double plan_time_s = 0.0;  ///< τ: the swarm is to form flow.mixture_at(τ)
  double plan_rate = 0.0;    ///< seconds of τ per second
  UtcTime received{};
};

struct ObservedEvent {
  UtcTime received{};
  std::string source;    ///< "planner", "launcher", "robot 7"
  std::string severity;  ///< info, warning or error
  std::string code;      ///< a word for programs
  std::string text;      ///< a sentence for people
};

/// Gets what a run publishes, checked: the live view and the metrics are observers, and so is a
/// guest's monitor. Override what you need. Calls come from one thread, in the order in which the
/// messages were received.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void on_mission(const Mission&) {}  ///< once, first of all
  virtual void on_plan(const ObservedPlan&) {}
  virtual void on_clock(const ObservedClock&) {}
  virtual void on_scene(const Scene&) {}
  virtual void on_state(const ObservedState&) {}
  virtual void on_status(const ObservedStatus&) {}
  virtual void on_event(const ObservedEvent&) {}
};

/// Reports a run in flight until `go_on()` is false; it is asked about fifty times a second. Joins
/// the run's bus without being counted among its participants. kEnvironment if there is no such
/// run.
Result<void> observe_run(const std::filesystem::path& run_dir, Observer& observer,
                         const std::function<bool()>& go_on);

/// Reports what a finished run directory, or a recording of one, holds: mission, plans, scenes,
/// then states and events in the order of their times.
Result<void> observe_recording(const std::filesystem::path& from, Observer& observer);

}  // namespace swarm::monitor
