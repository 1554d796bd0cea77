// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "swarm_core/app/control_socket.hpp"
#include "swarm_launcher/flight/beat_sender.hpp"
#include "swarm_launcher/flight/flight_log.hpp"
#include "swarm_launcher/flight/launcher_bus.hpp"
#include "swarm_launcher/flight/scene_keeper.hpp"
#include "swarm_launcher/flight/stop_order.hpp"
#include "swarm_launcher/hosts/remote_hosts.hpp"
#include "swarm_launcher/processes/spawner.hpp"
#include "swarm_launcher/supervision/fallen_body.hpp"
#include "swarm_launcher/supervision/progress.hpp"

/// Everything outside of itself that a FlightLoop uses.
namespace swarm::launcher {

class FlightLoop;

/// Requests of users to the run; shell::ControlServer in a real flight.
class ControlRequests {
 public:
  using ClientId = shell::ControlServer::ClientId;
  using Request = shell::ControlServer::Request;

  virtual ~ControlRequests() = default;
  /// The requests since the last call; never blocks. Each of them must be answered.
  virtual std::vector<Request> poll() = 0;
  virtual void answer(ClientId client, const std::string& text) = 0;
};

/// Codes of the events that a monitor has ended; without its recorder the recording is not whole.
inline constexpr std::string_view kMonitorExit = "monitor-exit";
inline constexpr std::string_view kRecorderExit = "recorder-exit";

/// Processes of the run that are neither planner nor agent: monitors and gateway.
class HelperProcesses {
 public:
  virtual ~HelperProcesses() = default;
  /// An event to log if the child that ended was one of them.
  virtual std::optional<LogEvent> on_exit(pid_t pid, SteadyTime now) = 0;
  /// Starts those again whose restart is due, and returns what to log.
  virtual std::vector<LogEvent> step(SteadyTime now) = 0;
  /// The number of robots behind the gateway of the run whose states it receives, as of the last
  /// step(); 0 without a gateway.
  virtual std::uint32_t robots_of_gateway() const = 0;
  /// A message for the user that has become available, once.
  virtual std::optional<std::string> message() = 0;
};

/// Receives what happens in a flight, in the thread that calls FlightLoop::step().
class FlightObserver {
 public:
  virtual ~FlightObserver() = default;
  /// A status that passed the Gate.
  virtual void on_status(const link::StatusMessage& status) = 0;
  /// A heartbeat of a planner that passed the Gate.
  virtual void on_heartbeat(SteadyTime /*now*/) {}
  /// Called in every step of the flight, every 20 ms or so. It must not block.
  virtual void on_step(const FlightLoop& flight, SteadyTime now) = 0;
  /// Text appended to the live line of the terminal.
  virtual std::string describe() = 0;
};

/// What a robot's process has recorded of its steps.
struct RecordedPositions {
  using Of = std::function<std::optional<LastKnown>(RobotId)>;
  Of last_step;  ///< of its process on this host, or as another host has sent it
  Of in_log;     ///< the newest in its log, if that is on this host
};

/// All of them outlive the FlightLoop.
struct FlightPorts {
  Spawner& spawner;
  LauncherBus& bus;
  SceneKeeper& scene;
  ControlRequests& control;
  HelperProcesses& helpers;
  FlightLog& log;
  Display& display;
  RecordedPositions recorded;
  std::string inputs{};          ///< file with what processes read first; empty: run directory
  std::string steps{};           ///< memory for the last steps of agents' robots; empty: none
  RemoteHosts* hosts = nullptr;  ///< null if all robots are on this host
  FlightObserver* observer = nullptr;   ///< null if there is none
  StopOrder* stop = nullptr;            ///< null if the interface carries no multicast
  link::StopReceiver* stops = nullptr;  ///< stops that commands send; null like `stop`
  BeatSender* beats = nullptr;          ///< null like `stop`
};

}  // namespace swarm::launcher
