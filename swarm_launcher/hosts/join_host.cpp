// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/join_host.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/app/foreign_settings.hpp"
#include "swarm_core/app/memory_file.hpp"
#include "swarm_core/app/run_clock.hpp"
#include "swarm_core/app/run_dir.hpp"
#include "swarm_core/app/run_inputs.hpp"
#include "swarm_core/app/shared_steps.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_launcher/hosts/host_processes.hpp"
#include "swarm_launcher/hosts/last_position.hpp"
#include "swarm_launcher/hosts/line_socket.hpp"
#include "swarm_launcher/hosts/offer.hpp"
#include "swarm_launcher/hosts/step_watch.hpp"
#include "swarm_launcher/supervision/progress.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

constexpr int kStep_ms = 20;
constexpr Duration kAnswerTimeout = std::chrono::seconds(10);
// Time between the signals of the ladder, as in the supervisor.
constexpr Duration kGrace = std::chrono::seconds(5);  // of each signal
constexpr Duration kLeastSilence = std::chrono::milliseconds(1250);
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

/// A robot that makes no step for this time is frozen, or its process is.
Duration step_silence(const Mission& mission) {
  return std::max(kLeastSilence, from_seconds(2.5 / mission.control.rate_hz));
}

/// The last steps of the robots of this host, which the launcher receives in flight.
struct LastSteps {
  const HostOffer& offer;
  const shell::SharedSteps& steps;
  const Mission& mission;
  StepWatch watch{steps, RobotId(offer.first_robot), offer.robots, step_silence(mission)};

  /// `is_last`: the robot makes no steps any more.
  void send(RobotId robot, bool is_last, LineSocket& socket) const {
    if (auto known = last_known(steps.last(robot), mission)) {
      known->is_last = is_last;
      socket.send(to_line(LastPosition{robot, *known}));
    }
  }
  /// Of the robots of a process that has ended.
  void send_of(std::uint32_t process, LineSocket& socket) const {
    const std::uint32_t begin = process * offer.per_process;
    for (std::uint32_t i = begin; i < std::min(begin + offer.per_process, offer.robots); ++i) {
      send(RobotId(offer.first_robot + i), true, socket);
    }
  }
};

/// Runs the processes until all have ended. They are ended when the launcher requests it, when the
/// connection is lost, or on a stop signal; a process that does not end gets the next stronger
/// signal.
void fly(HostProcesses& processes, LastSteps& last, LineSocket& socket, Progress& progress) {
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
    processes.step();
    for (const auto& [robot, is_silent] : last.watch.step(now())) {
      last.send(robot, is_silent, socket);
    }
    std::set<std::uint32_t> hung;
    for (const RobotId robot : last.watch.hung(now())) {
      hung.insert((robot.value() - last.offer.first_robot) / last.offer.per_process);
    }
    if (!hung.empty()) processes.kill_hung(hung);
    for (const auto& [process, exit] : processes.take_exits()) {
      last.send_of(process, socket);  // first, so that the launcher has it at the exit
      socket.send(nlohmann::json{{"exit", process},
                                 {"code", exit.code},
                                 {"signal", exit.signal},
                                 {"restarts", exit.is_restarted}}
                      .dump());
    }
    progress.show("flying", fmt::format("{} processes", processes.living()));
  }
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
  shell::catch_stop_signals(shell::Hangup::kStop);
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
  // In memory as well: a process can be started, too, when the run directory is full or gone.
  const auto inputs =
      shell::MemoryFile::make("swarmflow-inputs", shell::to_json(offer->run, offer->mission_yaml));
  if (!inputs) return tl::unexpected(inputs.error());
  const auto steps = shell::SharedSteps::make(RobotId(offer->first_robot), offer->robots);
  if (!steps) return tl::unexpected(steps.error());
  if (const auto notice = shell::dropped_settings_notice()) {
    std::fprintf(stderr, "%s\n", notice->c_str());
  }
  std::fprintf(stderr, "run directory: %s\nrobots %u-%u on %s\n", dir->c_str(), offer->first_robot,
               offer->first_robot + offer->robots - 1, offer->run.interface.c_str());
  Progress progress;
  {
    HostProcesses processes(*offer, {.dir = *dir,
                                     .steps = steps->path(),
                                     .inputs = inputs->path(),
                                     .dds = options.dds,
                                     .respawns = mission->launcher.respawn_agent_max});
    LastSteps last{.offer = *offer, .steps = *steps, .mission = *mission};
    fly(processes, last, *socket, progress);
  }
  send_logs(*offer, *dir, *socket, progress);
  if (!part(*socket)) {
    return fail(ErrorCode::kEnvironment,
                "the launcher is gone; the robot logs are in " + dir->string());
  }
  return ExitCode::kOk;
}

}  // namespace swarm::launcher
