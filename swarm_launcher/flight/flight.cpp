// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/flight.hpp"

#include <algorithm>
#include <cstdio>
#include <thread>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_core/mission_file/scene_change_file.hpp"
#include "swarm_launcher/processes/child_process.hpp"
#include "swarm_launcher/processes/host_limits.hpp"

namespace swarm::launcher {
namespace {

// Period of the loop, and so the largest delay of a command by the launcher.
constexpr Duration kFlightStep = std::chrono::milliseconds(20);
// Ownership strength of the first planner; lower values are left to planners on stand-by.
constexpr std::uint32_t kPlannerStrength = 100;

}  // namespace

Flight::Flight(std::unique_ptr<PreparedRun> run, FlightObserver* observer)
    : observer_(observer), run_(std::move(run)), events_(run_->dir() / shell::kEventsFile) {}

Result<std::unique_ptr<Flight>> Flight::make(FlightOptions options, FlightObserver* observer) {
  auto run = PreparedRun::make(std::move(options));
  if (!run) return tl::unexpected(run.error());
  auto flight = std::unique_ptr<Flight>(new Flight(std::move(*run), observer));
  if (const auto begun = flight->begin(); !begun) return tl::unexpected(begun.error());
  return flight;
}

// Only after an error are there children left: they must not outlive the launcher.
Flight::~Flight() {
  for (const auto& [pid, process] : children_) spawner_.signal(pid, EndSignal::kKill);
}

/// Reports which channel was chosen and why, and limits of this host that the run may exceed.
void Flight::report_channel() {
  const std::string text = fmt::format("robot states go by {}: {}",
                                       to_string(run_->channel().channel), run_->channel().reason);
  note(link::Severity::kInfo, "channel", text);
  std::fprintf(stderr, "%s\n", text.c_str());
  raise_open_files();
  for (const std::string& shortcoming :
       shortcomings(read_host_limits(), {.agents = run_->info().agents,
                                        .robots_per_process = run_->options().per_process,
                                        .relays = run_->info().relays})) {
    note(link::Severity::kWarning, "host-limits", shortcoming);
    std::fprintf(stderr, "%s\n", shortcoming.c_str());
  }
}

// The supervisor first: everything else is reported to it or to the log.
Result<void> Flight::begin() {
  const auto& [mission, per_process, how] = run_->options();
  supervisor_.emplace(
      SupervisorOptions{.robots = mission.robots.count,
                        .per_process = per_process,
                        .remote_processes = (how.remote + per_process - 1) / per_process,
                        .launcher = mission.launcher,
                        .script = mission.script},
      std::chrono::steady_clock::now());
  report_channel();
  reported_.resize(mission.robots.count);
  view_ = SwarmView(mission.robots.count, mission.link.communication_radius_m);
  monitors_.emplace(how.monitors, run_->dir());
  if (auto started = monitors_->start(); !started) return started;
  if (how.by_gateway > 0) {
    gateway_.emplace(run_->dir());
    if (auto started = gateway_->start(); !started) return started;
  }
  report_hosts();
  return {};
}

// Starts the planner or an agent process and remembers its pid. Which robots an agent process hosts
// follows from its index.
Result<void> Flight::start(ProcessIndex process) {
  std::vector<std::string> command_line;
  std::string log;
  if (process == kPlanner) {
    command_line = {program_or(run_->options().how.planner_program, "planner_service"), "--run",
                    run_->dir().string(),
                    // The topic of the plan belongs to a killed planner until its lease ends,
                    // unless its successor has a higher ownership strength.
                    "--strength", fmt::format("{}", kPlannerStrength + planner_starts_++)};
    log = "planner.log";
  } else {
    const auto [first, count] = supervisor_->robots_of(process);
    command_line = {program_or(run_->options().how.agent_program, "robot_agent"),
                    "--run",
                    run_->dir().string(),
                    "--ids",
                    fmt::format("{}", first.value()),
                    "--count",
                    fmt::format("{}", count),
                    "--number",
                    fmt::format("{}", process.value() - 1)};
    const bool by_gateway = process.value() <= run_->options().how.by_gateway;
    if (by_gateway || run_->options().how.agent_dds == AgentDds::kCycloneDds ||
        (run_->options().how.agent_dds == AgentDds::kHalf && process.value() % 2 == 0)) {
      command_line.insert(command_line.end(), {"--dds", "cyclonedds"});
    }
    if (by_gateway) command_line.emplace_back("--by-gateway");
    log = fmt::format("agent-{:05}.log", first.value());
  }
  if (!run_->options().how.fault.empty())
    command_line.insert(command_line.end(), {"--fault", run_->options().how.fault});
  command_line.insert(command_line.end(), {"--parent", fmt::format("{}", ::getpid())});
  const auto pid = spawner_.start(command_line, run_->dir() / shell::kLogsFolder / log);
  if (!pid) return tl::unexpected(pid.error());
  children_.emplace(*pid, process);
  return {};
}

// Changes the scene and logs it. The supervisor must know of a new goal, so that robots at the old
// one do not count as arrived.
Result<std::string> Flight::change(const SceneChange& change) {
  const UtcTime now = utc_now();
  const std::string what = fmt::format("{} {}", name_of(change), keys_of(change));
  auto changed = run_->scene().change(change, now);
  if (!changed) {
    note(link::Severity::kWarning, "scene-refused",
         fmt::format("{}: {}", what, changed.error().message));
    return changed;
  }
  if (std::holds_alternative<GoTo>(change)) supervisor_->on_new_goal(run_->scene().scene().version);
  note(link::Severity::kInfo, "scene", what);
  return changed;
}

// Only starting a process may fail the flight: without its processes it is of no use. Everything
// else is logged.
Result<void> Flight::act(const Action& action) {
  if (const auto* to_start = std::get_if<StartProcess>(&action)) return start(to_start->process);
  if (const auto* command = std::get_if<SendCommand>(&action)) {
    send(command->kind);
  } else if (const auto* scene = std::get_if<ChangeScene>(&action)) {
    if (const auto changed = change(scene->change); !changed) {
      progress_.print("the script's change was refused: " + changed.error().message);
    }
  } else if (const auto* signal = std::get_if<SignalProcess>(&action)) {
    for (const auto& [pid, process] : children_) {
      if (process == signal->process) spawner_.signal(pid, signal->signal);
    }
    if (run_->hosts() != nullptr) run_->hosts()->end(signal->process, signal->signal);
  } else if (const auto* fallen = std::get_if<AddBodies>(&action)) {
    add_bodies(fallen->robots);
  } else if (const auto* risen = std::get_if<ClearBodies>(&action)) {
    clear_bodies(risen->robots);
  } else if (const auto* event = std::get_if<LogEvent>(&action)) {
    log(*event);
  }
  return {};
}

// Children that are neither planner nor agent are monitors or the gateway.
void Flight::reap(SteadyTime now) {
  while (const auto child = spawner_.reap()) {
    const auto known = children_.find(child->pid);
    if (known == children_.end()) {
      const auto monitor = monitors_->on_exit(child->pid);
      if (monitor) log({.warning = true, .code = "monitor-exit", .text = *monitor});
      const auto gateway = gateway_ ? gateway_->on_exit(child->pid) : std::nullopt;
      if (gateway) log({.warning = true, .code = "gateway-exit", .text = *gateway});
      continue;
    }
    measurements_.cpu_s += child->cpu_s;
    measurements_.max_rss_mb = std::max(measurements_.max_rss_mb, child->max_rss_mb);
    supervisor_->on_exit(known->second, child->exit, now);
    children_.erase(known);
  }
}

// The first token is a mission command or a kind of scene change. A stop is answered only when all
// robots have confirmed it, see serve_control().
void Flight::serve(const shell::ControlServer::Request& request, SteadyTime now) {
  const std::size_t space = std::min(request.line.find(' '), request.line.size());
  const std::string word = request.line.substr(0, space);
  for (const CommandKind kind :
       {CommandKind::kStart, CommandKind::kPause, CommandKind::kResume, CommandKind::kStop}) {
    if (word != to_string(kind)) continue;
    supervisor_->on_command(kind, now);
    if (run_->hosts() != nullptr) run_->hosts()->on_user_command(kind);
    if (kind == CommandKind::kStop) {
      stopping_.push_back(request.client);
    } else {
      run_->control().answer(request.client, fmt::format("done: {} sent to {} robots", word,
                                                         run_->bus().commands->matched()));
    }
    return;
  }
  auto wanted = parse_scene_change(word, request.line.substr(space), run_->options().mission.world);
  if (wanted && std::holds_alternative<AddBody>(*wanted)) {
    wanted = fail(ErrorCode::kBadInput, "add_body: the launcher alone adds bodies");
  }
  const Result<std::string> changed = wanted ? change(*wanted) : tl::unexpected(wanted.error());
  run_->control().answer(
      request.client,
      changed ? "done: " + *changed : changed.error().message + "\nfailed: nothing changed");
}

// Answers waiting stop requests: when no robot is left that has not confirmed, or when the
// supervisor gives up and ends the run.
void Flight::serve_control(SteadyTime now) {
  for (const shell::ControlServer::Request& request : run_->control().poll()) serve(request, now);
  if (stopping_.empty() || supervisor_->phase() != MissionPhase::kStopped) return;
  const auto unstopped = supervisor_->unstopped();
  if (!unstopped.empty() && supervisor_->stage() != Supervisor::Stage::kEnding) return;
  const std::string answer =
      unstopped.empty()
          ? fmt::format("done: {} robots confirmed the stop", supervisor_->counts().stopped)
          : "failed: stop not confirmed by robots " + describe(unstopped);
  for (const shell::ControlServer::ClientId client : stopping_)
    run_->control().answer(client, answer);
  stopping_.clear();
}

// Four times a second: more often is hard to read, and describe() sums over all robots.
void Flight::show(SteadyTime now) {
  if (now - shown_at_ < std::chrono::milliseconds(250)) return;
  shown_at_ = now;
  const Supervisor::Counts c = supervisor_->counts();
  const std::uint32_t n = run_->options().mission.robots.count;
  progress_.show(headline_of(*supervisor_),
                 fmt::format("t {:.0f} s  ready {}/{}  arrived {}/{}  lost {}  {}",
                             supervisor_->mission_time(now).count(), c.ready, n, c.arrived, n,
                             c.lost, view_.describe(now)) +
                     (observer_ != nullptr ? "  " + observer_->describe() : ""));
}

// One step: signals, ended children, bus, other hosts, control requests; then the supervisor
// decides on what they reported, and its actions are executed.
Result<Measurements> Flight::fly() {
  while (supervisor_->stage() != Supervisor::Stage::kDone) {
    const SteadyTime now = std::chrono::steady_clock::now();
    for (; interrupts_seen_ < shell::stop_requests(); ++interrupts_seen_)
      supervisor_->on_interrupt();
    reap(now);
    read_bus(now);
    if (run_->hosts() != nullptr) {
      for (const LogEvent& event : run_->hosts()->step(*supervisor_, now)) log(event);
    }
    serve_control(now);
    for (const Action& action : supervisor_->step(now)) {
      if (auto done = act(action); !done) return tl::unexpected(done.error());
    }
    if (const auto address = monitors_->view_address()) progress_.print("view: " + *address);
    if (observer_ != nullptr) observer_->on_step(*this, now);
    show(now);
    std::this_thread::sleep_for(kFlightStep);
  }
  // After the last process: the recorder gets every message, and remote logs precede the audit.
  monitors_->finish();
  collect_robot_logs();
  // CPU time of the launcher itself, including the discovery server.
  rusage own = {};
  ::getrusage(RUSAGE_SELF, &own);
  measurements_.cpu_s += static_cast<double>(own.ru_utime.tv_sec + own.ru_stime.tv_sec) +
                         1e-6 * static_cast<double>(own.ru_utime.tv_usec + own.ru_stime.tv_usec);
  measurements_.discovery_s = supervisor_->discovery_s();
  measurements_.neighbour_discovery_s = supervisor_->neighbour_discovery_s();
  measurements_.refused_by_launcher = run_->bus().inbox.refused().total();
  measurements_.outcome = supervisor_->outcome();
  measurements_.channel = run_->channel().channel;
  return measurements_;
}

std::string Flight::planner_complaint() const {
  return shell::read_file(run_->dir() / shell::kLogsFolder / "planner.log", 1U << 20U).value_or("");
}

}  // namespace swarm::launcher
