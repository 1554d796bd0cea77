// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "swarm_launcher/hosts/host_watch.hpp"
#include "swarm_launcher/hosts/line_socket.hpp"
#include "swarm_launcher/hosts/offer.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {

/// The launcher's side of robots that other hosts start (`swarm_launcher join`). A host asks for a
/// number of them over TCP, is given the mission and how to meet, is given when to end them, and then
/// sends their robot logs home. In flight it is received by its robots' statuses alone: while one is
/// not, everybody else is paused, since the robots of the two sides do not see each other.
class RemoteHosts {
 public:
  /// `offer`: all robots that are for other hosts. `dir`: the run's directory.
  RemoteHosts(LineServer server, HostOffer offer, double status_hz, std::filesystem::path dir)
      : server_(std::move(server)),
        offer_(std::move(offer)),
        status_hz_(status_hz),
        dir_(std::move(dir)),
        free_({{0, offer_.robots}}),
        collected_(offer_.robots, false) {}

  std::uint16_t port() const { return server_.port(); }

  void on_status(RobotId robot, SteadyTime now);

  /// What people command is theirs: we do not take it back.
  void on_user_command(CommandKind kind);

  /// Takes what came, and tells the supervisor. Returns what there is to log.
  std::vector<LogEvent> step(Supervisor& supervisor, SteadyTime now);

  /// Ends a process of another host.
  void end(ProcessIndex process, EndSignal signal);

  /// Takes robot logs. Call it, after the flight, until it returns true.
  bool collect();
  /// Robot logs that were promised and are not here.
  std::uint32_t missing_logs() const;

 private:
  struct Host {
    LineSocket socket;
    SteadyTime came;
    HostWatch watch{1, 1.0};
    std::uint32_t first_robot = 0, robots = 0;  // none: it has not asked yet
    ProcessIndex first_process{};
    std::uint32_t processes = 0;
    int signalled = -1;         // strongest signal sent
    bool over = false;     // its processes have ended …
    bool counted = false;  // … and the supervisor knows
    bool left = false;     // it said good-bye, or is out of reach
    std::ofstream log_file{};
    std::uint32_t log_robot = 0;
    std::uint64_t log_bytes = 0;  // still to come
  };
  struct Block {  // of offer_'s robots
    std::uint32_t first;
    std::uint32_t robots;
  };

  void take(Host& host);
  bool take_line(Host& host, const std::string& line);
  bool answer(Host& host, std::uint32_t robots);
  void take_log(Host& host);
  void drop(Host& host);
  void pause_or_resume(bool cut, Supervisor& supervisor, SteadyTime now);

  LineServer server_;
  HostOffer offer_;
  double status_hz_;
  std::filesystem::path dir_;
  std::vector<Host> hosts_;
  std::vector<std::size_t> joined_;  // since the last step: indices of hosts_
  std::vector<Block> free_;          // nobody's yet
  std::vector<bool> collected_;           // robot logs
  bool paused_ = false;              // by us
  bool overruled_ = false;           // somebody resumed all the same
  bool begun_ = false;
};

}  // namespace swarm::launcher
