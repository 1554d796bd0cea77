// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "swarm_launcher/hosts/host_watch.hpp"
#include "swarm_launcher/hosts/line_socket.hpp"
#include "swarm_launcher/hosts/offer.hpp"
#include "swarm_launcher/supervision/fallen_body.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {

/// The launcher's side of robots that other hosts start (`swarm_launcher join`). A host requests a
/// number of robots over TCP, receives the mission and how to meet, is notified when to end them,
/// and then sends their robot logs. In flight a host is monitored by its robots' statuses only:
/// while they are not received, the mission is paused, because the robots of the two sides do not
/// receive each other. A host that has robots but whose robots never report is dropped, and they
/// are free for another one.
class RemoteHosts {
 public:
  /// `offer`: all robots that are for other hosts. `dir`: the run's directory.
  /// `token`: a host must know it to get robots; empty: none is needed.
  RemoteHosts(LineServer server, HostOffer offer, HostTimes times, std::filesystem::path dir,
              std::string token = {})
      : server_(std::move(server)),
        offer_(std::move(offer)),
        token_(std::move(token)),
        times_(times),
        dir_(std::move(dir)),
        free_({{0, offer_.robots}}),
        collected_(offer_.robots, false) {}

  std::uint16_t port() const { return server_.port(); }

  /// A status of a robot arrived. Robots of this host are ignored.
  void on_status(RobotId robot, SteadyTime now);

  /// A command of the user takes precedence: a pause of the user is not resumed automatically.
  void on_user_command(CommandKind kind);

  /// Accepts hosts, reads their lines and reports to the supervisor. Returns what to log.
  std::vector<LogEvent> step(Supervisor& supervisor, SteadyTime now);

  /// Processes of hosts that have ended since the last call.
  std::vector<ProcessIndex> take_ended() { return std::exchange(ended_, {}); }

  /// Where a robot of another host made its last step, as that host has sent it.
  std::optional<LastKnown> last_known(RobotId robot) const;

  /// Requests the end of a process of another host, and with it of all processes of that host.
  void end(ProcessIndex process, EndSignal signal);

  /// Receives robot logs. Call it after the flight until it returns true.
  bool collect();
  /// Number of robot logs that have not arrived completely.
  std::uint32_t missing_logs() const;

 private:
  /// A connection; a host once it has requested robots.
  struct Host {
    LineSocket socket;
    SteadyTime came;
    HostWatch watch{1, {}, came};
    std::uint32_t first_robot = 0, robots = 0;  // none: no request yet
    ProcessIndex first_process{};
    std::uint32_t processes = 0;
    int signalled = -1;    // strongest signal sent
    bool over = false;     // its processes have ended
    bool counted = false;  // the supervisor was informed of that
    bool left = false;     // it has left, or the connection is lost
    // Processes that have ended: those that the supervisor does not know of yet, and those that
    // will not come back.
    std::vector<std::pair<ProcessIndex, ProcessExit>> exits{};
    std::set<ProcessIndex> gone{};
    std::ofstream log_file{};
    std::uint32_t log_robot = 0;
    std::uint64_t log_bytes = 0;  // not received yet
  };
  struct Block {  // of offer_'s robots
    std::uint32_t first;
    std::uint32_t robots;
  };

  void make_free(const Block& block);
  void take(Host& host);
  /// False if the line is not valid: then the connection is dropped.
  bool take_line(Host& host, const std::string& line);
  bool answer(Host& host, std::uint32_t robots);
  bool refuse(Host& host, const char* why);
  bool take_exit(Host& host, const nlohmann::json& line);
  bool take_last(const Host& host, const nlohmann::json& line);
  void report_exits(Host& host, Supervisor& supervisor, SteadyTime now);
  void watch(Host& host, Supervisor& supervisor, SteadyTime now, std::vector<LogEvent>& log);
  void take_log(Host& host);
  void drop(Host& host);
  /// Pauses the mission while a host is cut off.
  void pause_or_resume(bool cut, Supervisor& supervisor, SteadyTime now);

  LineServer server_;
  HostOffer offer_;
  std::string token_;
  HostTimes times_;
  std::filesystem::path dir_;
  std::vector<Host> hosts_;
  std::vector<std::size_t> joined_;  // since the last step: indices of hosts_
  std::vector<ProcessIndex> ended_;  // since the last call of take_ended()
  std::map<RobotId, LastKnown> last_known_;
  std::vector<Block> free_;      // not assigned yet
  std::vector<bool> collected_;  // robot logs
  bool paused_ = false;          // by us
  bool overruled_ = false;       // the user resumed in spite of the cut
  bool cut_ = false;             // a host is cut off
  bool begun_ = false;
  SteadyTime now_{};  // of the step in progress
};

}  // namespace swarm::launcher
