// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robot_agent/inbox.hpp"
#include "robot_agent/loop/motion_permit.hpp"
#include "robot_agent/program/local_robot.hpp"
#include "swarm_core/app/file_watch.hpp"
#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/port.hpp"

namespace swarm::agent {

/// Reports what happens to a process as a whole (planner lost and back, messages refused, clock
/// differences, an id used twice, a full disk, why robots stand) as events on the bus and notes in
/// its first robot's log, and records the link's counters in all logs once a second.
class ProcessEvents {
 public:
  /// \pre robots is not empty; all outlive this
  ProcessEvents(std::span<LocalRobot> robots, link::Writer<link::EventMessage>& writer)
      : robots_(robots), writer_(writer) {}

  /// At the end of each tick. `state_age` is that of the states all robots used.
  void on_tick(SteadyTime now, UtcTime utc_now, Inbox& inbox, const Histogram& state_age);

  /// Reports when the robots of the process may no longer move, and when they may again; waking
  /// only once in ten seconds. A process that has not moved yet stands without a report.
  void on_permit(SteadyTime now, UtcTime utc_now, StandReason reason);

  /// Reports when the launcher's beats stop, and when they are back.
  void on_launcher(UtcTime utc_now, bool is_lost);

  /// Reports a tick that outlasted the bodies' commands, so that they stopped.
  void on_overrun(UtcTime utc_now, Duration took);

  /// Reports when writing files begins to fail, when it works again, and what was lost.
  void on_files(UtcTime utc_now, const shell::FileHealth& health);

  /// Reports what is missing in the logs at the end of the process. Nothing is logged any more.
  void on_losses(UtcTime utc_now, std::span<const shell::FileLoss> losses);

  /// Records the counters now.
  void record_link_stats(UtcTime utc_now, Inbox& inbox, const Histogram& state_age);

 private:
  void send(UtcTime utc_now, link::Severity severity, const std::string& code,
            const std::string& text);
  void announce(UtcTime utc_now, link::Severity severity, const std::string& code,
                const std::string& text);
  void announce_planner(SteadyTime now, UtcTime utc_now, const Inbox& inbox);
  void announce_faults(UtcTime utc_now);
  void announce_refusals(UtcTime utc_now, Inbox& inbox);
  void announce_duplicate(UtcTime utc_now, const Inbox& inbox);

  std::span<LocalRobot> robots_;
  link::Writer<link::EventMessage>& writer_;
  bool planner_was_alive_ = false;
  shell::FileWatch files_;
  bool launcher_was_lost_ = false;
  StandReason stand_ = StandReason::kCutOff;
  bool stand_reported_ = false;
  std::optional<SteadyTime> waking_reported_at_;
  bool has_moved_ = false;
  link::RefusalCounters reported_;  // announced already
  std::uint32_t skewed_reported_ = 0;
  bool duplicate_announced_ = false;
  SteadyTime stats_at_;
  std::vector<std::string> faults_;  // announced already, by robot
};

}  // namespace swarm::agent
