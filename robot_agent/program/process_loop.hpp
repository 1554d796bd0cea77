// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "robot_agent/inbox.hpp"
#include "robot_agent/loop/density_forecast.hpp"
#include "robot_agent/loop/motion_permit.hpp"
#include "robot_agent/neighbours/silent_robots.hpp"
#include "robot_agent/neighbours/whereabouts.hpp"
#include "robot_agent/program/bus_access.hpp"
#include "robot_agent/program/local_robot.hpp"
#include "robot_agent/program/plan_intake.hpp"
#include "robot_agent/program/process_events.hpp"
#include "robot_agent/program/status_report.hpp"
#include "swarm_core/app/file_thread.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::agent {

/// The tick of an agent process: receives once for all of its robots, steps each one's loop,
/// publishes their states and reports on them. It takes the time as an argument and neither sleeps
/// nor handles signals.
///
/// Each robot decides alone, from what it receives on the bus, also of robots in the same process;
/// they share the bus access, the map and the clock, nothing else.
class ProcessLoop {
 public:
  /// The robots refer to `*world`, which this object changes as the scene changes. The mission
  /// outlives it. \pre the access has a state channel
  ProcessLoop(const Mission& mission, std::unique_ptr<World> world, LocalRobots robots,
              BusAccess bus);
  ProcessLoop(const ProcessLoop&) = delete;
  ProcessLoop& operator=(const ProcessLoop&) = delete;

  /// When a tick takes place.
  struct Time {
    SteadyTime now;
    UtcTime utc_now;
    Duration lateness{};  ///< actual start minus that of the oldest tick that was due
  };
  void tick(const Time& time);

  /// Reports a tick that outlasted the bodies' commands.
  void on_overrun(UtcTime utc_now, Duration took) { events_.on_overrun(utc_now, took); }

  /// Reports on the files of the process; see ProcessEvents.
  void on_files(UtcTime utc_now, const shell::FileHealth& health) {
    events_.on_files(utc_now, health);
  }

  /// Records and reports for the last time, and shuts the drivers down.
  void end(const Time& time);

  /// After end(), when nothing is written any more.
  void on_losses(UtcTime utc_now, std::span<const shell::FileLoss> losses) {
    events_.on_losses(utc_now, losses);
  }

 private:
  void receive(const Time& time);
  void find_silent(SteadyTime now);
  bool may_move(SteadyTime now, UtcTime utc_now);
  bool is_obstacle() const;
  bool leads(SteadyTime now) const;
  void confirm_stop();
  void follow_scene(const Time& time);
  void step_robots(RobotTick tick, const std::optional<TakenPlan>& new_plan);
  const PlannedDensity* planned_density(const std::optional<PlanTime>& plan_time);
  StatusReport::Source source(const Time& time) {
    return {local_.robots, inbox_, state_age_, time.now, time.utc_now};
  }

  const Mission& mission_;
  Duration period_;
  std::unique_ptr<World> world_;  // as it is now
  LocalRobots local_;
  BusAccess bus_;
  Inbox inbox_;
  Whereabouts whereabouts_;
  SilentRobots silent_;
  MotionPermit permit_;
  PlanIntake plans_;
  StatusReport status_;
  ProcessEvents events_;
  Scene scene_;
  bool world_moves_ = false;
  Histogram state_age_;  // of the states that all robots used
  DensityForecast density_;
  std::vector<link::RobotStateMessage> published_;
  std::vector<Vec2> positions_m_;
};

}  // namespace swarm::agent
