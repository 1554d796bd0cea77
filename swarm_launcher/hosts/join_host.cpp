// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/join_host.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "swarm_core/app/foreign_settings.hpp"
#include "swarm_core/app/run_clock.hpp"
#include "swarm_core/app/run_dir.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_launcher/hosts/line_socket.hpp"
#include "swarm_launcher/hosts/offer.hpp"
#include "swarm_launcher/processes/child_process.hpp"
#include "swarm_launcher/supervision/progress.hpp"
#include "swarm_launcher/supervision/restart_policy.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

constexpr int kStep_ms = 20;
constexpr Duration kAnswerTimeout = std::chrono::seconds(10);
constexpr Duration kStartEvery = std::chrono::milliseconds(50);  // starting processes compete
// Time between the signals of the ladder, as in the supervisor.
constexpr Duration kGrace = std::chrono::seconds(5);  // of each signal
constexpr std::size_t kMaxLogBytes = 1U << 30U;

SteadyTime now() { return std::chrono::steady_clock::now(); }

// Requests robots and waits for the offer. It was sent between our request and its arrival: taking
// the middle, the two hosts' clocks agree to half of that time, a few hundredths of a second.
Result<HostOffer> ask(LineSocket& socket, const JoinOptions& options) {
  nlohmann::json request = {{"join", options.robots}};
  if (!options.token.empty()) request["token"] = options.token;
  const SteadyTime asked = now();
  socket.send(request.dump());
  for (const SteadyTime until = now() + kAnswerTimeout; now() < until && !socket.gone();) {
    socket.wait(kStep_ms);
    socket.flush();
    socket.receive();
    const auto line = socket.line();
    if (!line) continue;
    auto offer = parse_offer(*line);
    if (!offer) return offer;
    shell::follow(offer->sent_at, asked + (now() - asked) / 2);
    offer->run.clock = shell::own_clock();
    return offer;
  }
  return fail(ErrorCode::kEnvironment, "no launcher answers there");
}

/// The agent processes of this host: started one after the other, restarted as on the launcher's
/// host (see RestartPolicy), and killed when the object is destroyed.
class HostProcesses {
 public:
  HostProcesses(const HostOffer& offer, std::filesystem::path dir, link::Vendor dds,
                std::uint32_t respawns)
      : offer_(offer), dir_(std::move(dir)), dds_(dds), respawns_(respawns) {
    for (std::uint32_t robot = 0; robot < offer.robots; robot += offer.per_process) {
      waiting_.push_back({.robot = robot});
    }
  }
  ~HostProcesses() { signal(SIGKILL); }
  HostProcesses(const HostProcesses&) = delete;
  HostProcesses& operator=(const HostProcesses&) = delete;

  // Reaps processes that ended, queues the restarts, and starts the next process that is due.
  Result<void> step() {
    while (const auto child = reap_child()) {
      const auto known = children_.find(child->pid);
      if (known == children_.end()) continue;
      const std::uint32_t robot = known->second;
      children_.erase(known);
      if (ending_) continue;
      ProcessExit exit = child->exit;
      RestartPolicy& restarts = restarts_[robot];
      const Duration delay = restarts.on_exit(now());
      exit.is_restarted = restarts.deaths_in_a_row() <= respawns_;
      if (exit.is_restarted) waiting_.push_back({.robot = robot, .due = now() + delay});
      exits_.emplace_back(robot / offer_.per_process, exit);
    }
    if (ending_ || waiting_.empty() || now() < next_start_) return {};
    const auto next = std::find_if(waiting_.begin(), waiting_.end(),
                                   [at = now()](const Waiting& w) { return w.due <= at; });
    if (next == waiting_.end()) return {};
    next_start_ = now() + kStartEvery;
    const std::uint32_t robot = next->robot;
    waiting_.erase(next);
    restarts_[robot].on_start(now());
    return start(robot);
  }

  // Numbers of the processes that have ended since the last call, counted from our first.
  std::vector<std::pair<std::uint32_t, ProcessExit>> take_exits() {
    return std::exchange(exits_, {});
  }

  // From the first signal on no process is started or restarted.
  void signal(int number) {
    ending_ = true;
    for (const auto& [pid, robot] : children_) ::kill(pid, number);
  }

  // All processes have ended and none is to be started.
  bool over() const { return children_.empty() && (ending_ || waiting_.empty()); }
  std::size_t living() const { return children_.size(); }

 private:
  /// A process that is to be started.
  struct Waiting {
    std::uint32_t robot = 0;  ///< its first robot, counted from our first
    SteadyTime due{};         ///< not before this
  };

  Result<void> start(std::uint32_t robot) {
    const std::uint32_t id = offer_.first_robot + robot;
    std::vector<std::string> command_line = {
        sibling_program("robot_agent"),
        "--run",
        dir_.string(),
        "--ids",
        fmt::format("{}", id),
        "--count",
        fmt::format("{}", std::min(offer_.per_process, offer_.robots - robot)),
        "--number",
        fmt::format("{}", offer_.first_process + robot / offer_.per_process),
        "--parent",
        fmt::format("{}", ::getpid())};
    if (!offer_.fault.empty()) command_line.insert(command_line.end(), {"--fault", offer_.fault});
    if (dds_ != link::Vendor::kFastDds) {
      command_line.insert(command_line.end(), {"--dds", std::string(to_string(dds_))});
    }
    const auto pid =
        start_process(command_line, dir_ / shell::kLogsFolder / fmt::format("agent-{:05}.log", id));
    if (!pid) return tl::unexpected(pid.error());
    children_.emplace(*pid, robot);
    return {};
  }

  const HostOffer& offer_;
  std::filesystem::path dir_;
  link::Vendor dds_;
  std::uint32_t respawns_;
  std::vector<Waiting> waiting_;
  std::map<pid_t, std::uint32_t> children_;          // first robot of each process, as in Waiting
  std::map<std::uint32_t, RestartPolicy> restarts_;  // by the same number
  std::vector<std::pair<std::uint32_t, ProcessExit>> exits_;
  SteadyTime next_start_;
  bool ending_ = false;
};

/// Runs the processes until all have ended. They are ended when the launcher requests it, when the
/// connection is lost, or on a stop signal; a process that does not end gets the next stronger
/// signal.
Result<void> fly(HostProcesses& processes, LineSocket& socket, Progress& progress) {
  int signalled = -1;
  SteadyTime signalled_at;
  const auto signal_processes = [&](int rung) {
    signalled = std::min(rung, 2);
    signalled_at = now();
    processes.signal(number_of(static_cast<EndSignal>(signalled)));
  };
  while (!processes.over()) {
    socket.wait(kStep_ms);
    socket.flush();
    socket.receive();
    while (const auto line = socket.line()) {
      const auto json = nlohmann::json::parse(*line, nullptr, false);
      const auto end = json.is_object() ? json.find("end") : json.end();
      if (end == json.end() || !end->is_number_integer()) continue;
      const int rung = std::clamp(end->get<int>(), 0, 2);
      if (rung > signalled) signal_processes(rung);
    }
    if (signalled < 0 && (socket.gone() || shell::stop_requests() > 0)) signal_processes(0);
    if (signalled >= 0 && signalled < 2 && now() - signalled_at > kGrace)
      signal_processes(signalled + 1);
    if (auto stepped = processes.step(); !stepped) return stepped;
    for (const auto& [process, exit] : processes.take_exits()) {
      socket.send(nlohmann::json{{"exit", process},
                                 {"code", exit.code},
                                 {"signal", exit.signal},
                                 {"restarts", exit.is_restarted}}
                      .dump());
    }
    progress.show("flying", fmt::format("{} processes", processes.living()));
  }
  return {};
}

/// Discards what the launcher still sends. Unread input would make the kernel reset the connection
/// at its end and discard our last bytes.
void drain(LineSocket& socket) {
  socket.receive();
  while (!socket.bytes(1U << 16U).empty()) {
  }
}

/// Sends the robot logs one after the other, each as a line with its size and the bytes. Only one
/// log is in memory at a time.
void send_logs(const HostOffer& offer, const std::filesystem::path& dir, LineSocket& socket,
               Progress& progress) {
  socket.send(R"({"over": true})");
  for (std::uint32_t i = 0; i <= offer.robots && !socket.gone(); ++i) {
    if (i < offer.robots) {
      const RobotId robot(offer.first_robot + i);
      const auto log_file = shell::read_file(robot_log::file_of(dir, robot), kMaxLogBytes);
      if (!log_file || log_file->empty()) continue;
      socket.send(nlohmann::json{{"box", robot.value()}, {"bytes", log_file->size()}}.dump());
      socket.send_bytes(*log_file);
    } else {
      socket.send(R"({"bye": true})");
    }
    while (socket.unsent() > 0 && !socket.gone()) {
      socket.flush();
      socket.wait(kStep_ms);
      drain(socket);
      progress.show("ending", fmt::format("{} of {} robot logs sent", i, offer.robots));
    }
  }
}

/// Ends the connection after the launcher has read everything. False if it was lost before.
bool part(LineSocket& socket) {
  if (socket.gone()) return false;
  socket.finish();
  for (const SteadyTime until = now() + kAnswerTimeout; now() < until && !socket.gone();) {
    socket.wait(kStep_ms);
    drain(socket);
  }
  return true;
}

}  // namespace

// The run directory is created before the request, so that robots are not reserved in vain. The
// offer is checked against the mission that it contains.
Result<ExitCode> join_host(const JoinOptions& options) {
  const auto to = parse_host_port(options.launcher);
  if (!to) return tl::unexpected(to.error());
  auto socket = LineSocket::connect(*to);
  if (!socket) return tl::unexpected(socket.error());
  const auto dir = shell::make_run_dir(options.out, "joined");
  if (!dir) return tl::unexpected(dir.error());
  auto offer = ask(*socket, options);
  if (!offer) return tl::unexpected(offer.error());
  offer->run.interface = options.interface.empty() ? socket->own_address() : options.interface;
  const auto mission_file = *dir / shell::kMissionFile;
  if (auto written = shell::write_file(mission_file, offer->mission_yaml); !written) {
    return tl::unexpected(written.error());
  }
  const auto mission = load_mission(mission_file, open_catalogue());
  if (!mission) return tl::unexpected(mission.error());
  if (offer->first_robot + offer->robots > mission->robots.count) {
    return fail(ErrorCode::kBadInput, "the launcher's offer does not fit its mission");
  }
  if (auto written = shell::write_run_info(*dir, offer->run); !written) {
    return tl::unexpected(written.error());
  }
  if (const auto notice = shell::dropped_settings_notice()) {
    std::fprintf(stderr, "%s\n", notice->c_str());
  }
  std::fprintf(stderr, "run directory: %s\nrobots %u-%u on %s\n", dir->c_str(), offer->first_robot,
               offer->first_robot + offer->robots - 1, offer->run.interface.c_str());
  Progress progress;
  {
    HostProcesses processes(*offer, *dir, options.dds, mission->launcher.respawn_agent_max);
    if (auto flown = fly(processes, *socket, progress); !flown)
      return tl::unexpected(flown.error());
  }
  send_logs(*offer, *dir, *socket, progress);
  if (!part(*socket)) {
    return fail(ErrorCode::kEnvironment,
                "the launcher is gone; the robot logs are in " + dir->string());
  }
  return ExitCode::kOk;
}

}  // namespace swarm::launcher
