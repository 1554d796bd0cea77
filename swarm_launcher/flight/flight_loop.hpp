// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <sys/types.h>

#include "swarm_launcher/flight/confirmations.hpp"
#include "swarm_launcher/flight/fallen_robots.hpp"
#include "swarm_launcher/flight/flight_choices.hpp"
#include "swarm_launcher/flight/flight_ports.hpp"
#include "swarm_launcher/flight/flight_time.hpp"
#include "swarm_launcher/flight/foreign_orders.hpp"
#include "swarm_launcher/flight/late_robots.hpp"
#include "swarm_launcher/flight/swarm_view.hpp"
#include "swarm_launcher/supervision/event_throttle.hpp"
#include "swarm_launcher/supervision/summary.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {

/// Flies one mission: the Supervisor decides, the loop executes its decisions and reports back what
/// came of them. The caller calls step() every 20 ms or so with the time; all else is behind the
/// ports. No threads, no signal handlers, no clock. Not thread-safe.
class FlightLoop {
 public:
  /// \pre `options` and everything in `ports` outlive the loop
  FlightLoop(const FlightOptions& options, const std::filesystem::path& dir, FlightPorts ports,
             SteadyTime now);
  /// Kills the processes that still run, which there are only after an error.
  ~FlightLoop();
  FlightLoop(const FlightLoop&) = delete;
  FlightLoop& operator=(const FlightLoop&) = delete;

  /// The user wants the run to end; the second time, at once.
  void interrupt() { supervisor_.on_interrupt(); }

  /// Takes what has arrived, decides, and acts. Fails only if a process cannot be started: without
  /// its processes a flight is of no use.
  Result<void> step(const FlightTime& now);

  /// All processes have ended.
  bool is_done() const { return supervisor_.stage() == Supervisor::Stage::kDone; }

  const Supervisor& supervisor() const { return supervisor_; }
  /// Running planner and agent processes of this host.
  const std::map<pid_t, ProcessIndex>& children() const { return children_; }
  /// So far, of planner and agents; of the launcher itself nothing.
  Measurements measurements() const;

 private:
  /// The parts of a step, in their order.
  bool is_gateway_matched(SteadyTime now) const;
  void reap(const FlightTime& now);
  void release(ProcessIndex process, UtcTime now);
  void read_bus(const FlightTime& now);
  void read_events(const FlightTime& now);
  void read_stops(SteadyTime now);
  void report_refusals(const FlightTime& now);
  void overrule(const FlightTime& now);
  void serve_requests(const FlightTime& now);
  Result<void> act(const Action& action, const FlightTime& now);
  void show(SteadyTime now);

  void on_status(const link::StatusMessage& status, const FlightTime& now);
  /// Executes one request of a user and answers it.
  void serve(const ControlRequests::Request& request, const FlightTime& now);
  void serve_command(CommandKind kind, ControlRequests::ClientId client, SteadyTime now);
  void answer_stops();
  /// Why a change makes no sense in this mission, now; nothing if it does.
  std::optional<std::string> objection_to(const SceneChange& change) const;

  Result<void> start(ProcessIndex process);
  void signal(const SignalProcess& action);
  void send(CommandKind kind, UtcTime now);
  void send_stop(const FlightTime& now);
  Result<std::string> change(const SceneChange& change, UtcTime now);

  const FlightOptions& options_;
  std::filesystem::path dir_;
  FlightPorts ports_;
  Supervisor supervisor_;
  SwarmView view_;
  LateRobots late_;
  FallenRobots fallen_;
  Duration stamp_tolerance_;  ///< of statuses that confirm commands
  Duration clock_skew_refuse_;
  Confirmations confirmations_;
  std::optional<SentCommand> stop_;  ///< the emergency stop, once it was sent
  ForeignOrders foreign_;
  SteadyTime overruled_at_;
  EventThrottle throttle_;
  std::set<std::uint32_t> duplicates_;  ///< robots whose duplicate id was displayed
  std::map<pid_t, ProcessIndex> children_;
  std::vector<ControlRequests::ClientId> stopping_;  // wait for the confirmation of a stop
  Measurements measurements_;
  SteadyTime shown_at_;  ///< last update of the live line
  link::RefusalCounters reported_refusals_;
  SteadyTime refusals_reported_at_;
  std::uint64_t last_command_id_ = 0;  ///< of commands other than a stop
};

}  // namespace swarm::launcher
