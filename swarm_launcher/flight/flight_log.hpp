// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "swarm_launcher/supervision/event_log.hpp"
#include "swarm_launcher/supervision/progress.hpp"
#include "swarm_link/endpoints.hpp"

namespace swarm::launcher {

/// Writes events to the event log and publishes them for monitors. Not thread-safe.
class FlightLog {
 public:
  /// \pre all three outlive the log
  FlightLog(EventLog& file, link::Writer<link::EventMessage>& relay, Display& display)
      : file_(file), relay_(relay), display_(display) {}

  /// An event of the launcher.
  void note(UtcTime now, link::Severity severity, const std::string& code, const std::string& text);
  /// As note(); a warning is also displayed.
  void log(UtcTime now, const LogEvent& event);
  /// An event of a robot or the planner.
  void forward(const link::EventMessage& event);

  /// Something that the records of the run lack for good.
  void add_loss(const std::string& what);
  /// The process of these sources was killed. If it could not write its files at that time, what it
  /// had not written is lost.
  void on_killed(std::uint32_t first_source, std::uint32_t sources);
  /// What add_loss() got, and what processes reported as lost from their files; the first hundred.
  const std::vector<std::string>& losses() const { return losses_; }

 private:
  EventLog& file_;
  link::Writer<link::EventMessage>& relay_;
  Display& display_;
  std::vector<std::string> losses_;
  std::set<std::uint32_t> failing_;  // sources that cannot write their files
};

}  // namespace swarm::launcher
