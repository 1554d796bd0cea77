// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

#include "swarm_core/app/control_socket.hpp"
#include "swarm_core/mission/channel.hpp"
#include "swarm_launcher/flight/gateway.hpp"
#include "swarm_launcher/flight/monitors.hpp"
#include "swarm_launcher/flight/prepared_run.hpp"
#include "swarm_launcher/flight/swarm_view.hpp"
#include "swarm_launcher/processes/child_process.hpp"
#include "swarm_launcher/supervision/event_log.hpp"
#include "swarm_launcher/supervision/fallen_body.hpp"
#include "swarm_launcher/supervision/progress.hpp"
#include "swarm_launcher/supervision/summary.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"
#include "swarm_link/messages.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::launcher {

class Flight;

/// Receives what happens in a flight, in the thread that calls fly().
class FlightObserver {
 public:
  virtual ~FlightObserver() = default;
  /// A status that passed the Gate.
  virtual void on_status(const link::StatusMessage& status) = 0;
  /// Called in every step of the flight, every 20 ms or so. It must not block.
  virtual void on_step(const Flight& flight, SteadyTime now) = 0;
  /// Text appended to the live line of the terminal.
  virtual std::string describe() = 0;
};

/// Executes the decisions of the Supervisor: it owns processes, bus, files and terminal. Single
/// thread; the Supervisor decides, the flight acts and reports back.
class Flight {
 public:
  /// Prepares the run, see PreparedRun. \pre the observer, if any, outlives the flight
  static Result<std::unique_ptr<Flight>> make(FlightOptions options,
                                              FlightObserver* observer = nullptr);
  ~Flight();
  Flight(const Flight&) = delete;
  Flight& operator=(const Flight&) = delete;

  /// Flies the whole mission, from the first process to the last. Call it once.
  Result<Measurements> fly();

  const std::filesystem::path& dir() const { return run_->dir(); }
  Channel channel() const { return run_->channel().channel; }
  std::uint32_t domain() const { return run_->info().domain; }
  const Supervisor& supervisor() const { return *supervisor_; }
  /// Running planner and agent processes of this host.
  const std::map<pid_t, ProcessIndex>& children() const { return children_; }
  /// The planner's log, for the user when planning failed.
  std::string planner_complaint() const;

 private:
  Flight(std::unique_ptr<PreparedRun> run, FlightObserver* observer);

  /// Creates the supervisor and starts the processes that are neither planner nor agent.
  Result<void> begin();
  void report_channel();
  /// Prints where other hosts join.
  void report_hosts();
  /// Executes one decision of the Supervisor.
  Result<void> act(const Action& action);
  Result<void> start(ProcessIndex process);
  /// Writes an event to the event log and publishes it; warnings are also printed.
  void log(const LogEvent& event);
  void note(link::Severity severity, const std::string& code, const std::string& text);
  /// Waits for the robot logs of other hosts, a few minutes at most.
  void collect_robot_logs();
  void send(CommandKind kind);
  Result<std::string> change(const SceneChange& change);
  /// Fallen robots: their bodies become obstacles, or cease to be.
  void add_bodies(std::span<const RobotId> robots);
  void clear_bodies(std::span<const RobotId> robots);
  std::optional<LastKnown> last_known_of(RobotId robot) const;
  /// Executes one request of the control socket and answers it.
  void serve(const shell::ControlServer::Request& request, SteadyTime now);
  /// Collects children that have ended.
  void reap(SteadyTime now);
  void read_bus(SteadyTime now);
  void serve_control(SteadyTime now);
  void show(SteadyTime now);

  FlightObserver* observer_;
  std::unique_ptr<PreparedRun> run_;
  ChildSpawner spawner_;
  EventLog events_;
  Progress progress_;
  std::optional<GatewayKeeper> gateway_;
  std::optional<Monitors> monitors_;
  std::vector<shell::ControlServer::ClientId>
      stopping_;  // clients that wait for the confirmation of a stop
  std::optional<Supervisor> supervisor_;
  SwarmView view_;
  std::vector<std::optional<LastKnown>> reported_;  // by the newest status of each robot
  std::map<pid_t, ProcessIndex> children_;
  Measurements measurements_;
  SteadyTime shown_at_;  ///< last update of the live line
  int interrupts_seen_ = 0;
  std::uint32_t planner_starts_ = 0;  ///< for the ownership strength of the next one
};

}  // namespace swarm::launcher
