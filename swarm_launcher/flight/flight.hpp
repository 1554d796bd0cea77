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

#include "swarmflow/core/result.hpp"
#include "swarm_core/mission/channel.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarm_core/app/control_socket.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_launcher/processes/channel_choice.hpp"
#include "swarm_launcher/supervision/event_log.hpp"
#include "swarm_launcher/supervision/fallen_body.hpp"
#include "swarm_launcher/flight/flight_choices.hpp"
#include "swarm_launcher/flight/gateway.hpp"
#include "swarm_launcher/flight/health_inbox.hpp"
#include "swarm_launcher/hosts/remote_hosts.hpp"
#include "swarm_launcher/flight/monitors.hpp"
#include "swarm_launcher/supervision/progress.hpp"
#include "swarm_launcher/flight/scene_keeper.hpp"
#include "swarm_launcher/supervision/summary.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"
#include "swarm_launcher/flight/swarm_view.hpp"
#include "swarm_link/roles/domain_lock.hpp"
#include "swarm_link/roles/join.hpp"
#include "swarm_link/messages.hpp"

namespace swarm::launcher {

struct FlightOptions {
  Mission mission;
  std::uint32_t per_process = 1;
  FlightChoices how{};
};

class Flight;

/// Whoever wants to look on.
class FlightObserver {
 public:
  virtual ~FlightObserver() = default;
  virtual void on_status(const link::StatusMessage& status) = 0;
  /// Every few milliseconds, in the thread that flies.
  virtual void on_step(const Flight& flight, SteadyTime now) = 0;
  /// For the live line.
  virtual std::string describe() = 0;
};

/// The imperative shell around the Supervisor: processes, bus, files, terminal.
class Flight {
 public:
  /// Joins the bus and makes the run directory. \pre the observer, if any, outlives the flight
  static Result<std::unique_ptr<Flight>> make(FlightOptions options,
                                              FlightObserver* observer = nullptr);
  ~Flight();
  Flight(const Flight&) = delete;
  Flight& operator=(const Flight&) = delete;

  /// The whole mission. Once.
  Result<Measurements> fly();

  const std::filesystem::path& dir() const { return dir_; }
  Channel channel() const { return channel_.channel; }
  std::uint32_t domain() const { return lock_.domain(); }
  const Supervisor& supervisor() const { return *supervisor_; }
  const std::map<pid_t, ProcessIndex>& children() const { return children_; }
  std::string planner_complaint() const;

 private:
  Flight(FlightOptions options, FlightObserver* observer, std::filesystem::path dir,
         link::DomainLock lock, ChannelChoice channel, std::uint32_t relays);

  Result<void> join();
  Result<void> act(const Action& action);
  Result<void> start(ProcessIndex process);
  Result<void> open_to_hosts(const shell::RunInfo& run);
  void log(const LogEvent& event);
  void note(link::Severity severity, const std::string& code, const std::string& text);
  void collect_robot_logs();
  void send(CommandKind kind);
  Result<std::string> change(const SceneChange& change);
  void add_bodies(std::span<const RobotId> robots);
  void clear_bodies(std::span<const RobotId> robots);
  std::optional<LastKnown> last_known_of(RobotId robot) const;
  void serve(const shell::ControlServer::Request& request, SteadyTime now);
  void reap(SteadyTime now);
  void read_bus(SteadyTime now);
  void serve_control(SteadyTime now);
  void show(SteadyTime now);

  FlightOptions options_;
  FlightObserver* observer_;
  ChannelChoice channel_;
  std::uint32_t relays_;
  std::filesystem::path dir_;
  link::DomainLock lock_;
  EventLog events_;
  Progress progress_;
  std::unique_ptr<link::DiscoveryServer> server_;  // none where hubs are the meeting place
  std::unique_ptr<link::Participant> participant_;
  std::optional<HealthInbox> inbox_;
  link::WriterPtr<link::CommandMessage> command_writer_;
  link::WriterPtr<link::StatusMessage> status_relay_;  // for monitors
  link::WriterPtr<link::EventMessage> event_relay_;
  std::optional<shell::ControlServer> control_;
  std::optional<RemoteHosts> hosts_;
  std::optional<GatewayKeeper> gateway_;
  std::optional<Monitors> monitors_;
  std::vector<shell::ControlServer::ClientId>
      stopping_;  // clients who wait for a stop to be confirmed
  std::optional<SceneKeeper> scene_;
  std::optional<Supervisor> supervisor_;
  SwarmView view_;
  std::vector<std::optional<LastKnown>> reported_;  // by the newest status of each robot
  std::map<pid_t, ProcessIndex> children_;
  Measurements measurements_;
  SteadyTime shown_at_;
  int interrupts_seen_ = 0;
  std::uint32_t planner_starts_ = 0;
};

}  // namespace swarm::launcher
