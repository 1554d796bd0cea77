// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "robot_agent/inbox.hpp"
#include "robot_agent/loop/status_cadence.hpp"
#include "robot_agent/program/local_robot.hpp"
#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/port.hpp"

namespace swarm::agent {

/// Publishes the status of the robots of a process: groups of them in turn, at the mission's rate
/// and at once whenever a robot changes its mode or comes to rest, a command is obeyed, or the
/// process wakes after it slept for longer than a status period.
class StatusReport {
 public:
  StatusReport(const Mission& mission, link::Writer<link::StatusMessage>& writer)
      : cadence_(mission.control.rate_hz, mission.link.status_hz),
        writer_(writer),
        status_period_(from_seconds(1.0 / mission.link.status_hz)) {}

  /// The data of a status message.
  struct Source {
    std::span<const LocalRobot> robots;
    Inbox& inbox;
    const Histogram& state_age;  ///< of the states that all of them used
    SteadyTime now;
    UtcTime utc_now;
  };

  /// At the end of each tick: publishes what is due.
  void on_tick(const Source& source);

  /// Publishes the status of all robots now.
  void publish_all(const Source& source);

 private:
  void publish_group(const Source& source, std::size_t first);

  StatusCadence cadence_;
  link::Writer<link::StatusMessage>& writer_;
  link::StatusMessage message_;  // reused, so that no tick allocates
  Duration status_period_;
  std::optional<SteadyTime> last_tick_;
  std::uint64_t ticks_ = 0;
  std::uint32_t plan_reported_ = 0;     // version
  std::uint64_t command_reported_ = 0;  // id
};

}  // namespace swarm::agent
