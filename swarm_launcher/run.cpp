// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/run.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <map>
#include <thread>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_core/mission/mission_file.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarm_core/mission/scene_change_file.hpp"
#include "swarm_core/shell/run_directory.hpp"
#include "swarm_core/shell/stop_signal.hpp"
#include "swarm_launcher/channel_choice.hpp"
#include "swarm_launcher/child_process.hpp"
#include "swarm_launcher/control_socket.hpp"
#include "swarm_launcher/domain_lock.hpp"
#include "swarm_launcher/event_log.hpp"
#include "swarm_launcher/progress.hpp"
#include "swarm_launcher/run_dir.hpp"
#include "swarm_launcher/scene_keeper.hpp"
#include "swarm_launcher/summary.hpp"
#include "swarm_launcher/supervisor.hpp"
#include "swarm_launcher/swarm_view.hpp"
#include "swarm_link/join.hpp"
#include "swarm_link/udp_socket.hpp"
#include "swarm_link/validation.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(20);
constexpr std::uint32_t kPlannerStrength = 100;

int number_of(EndSignal signal) {
  switch (signal) {
    case EndSignal::kInterrupt:
      return SIGINT;
    case EndSignal::kTerminate:
      return SIGTERM;
    case EndSignal::kKill:
      return SIGKILL;
  }
  return SIGKILL;
}

/// The imperative shell around the Supervisor: processes, bus, files, terminal.
class Run {
 public:
  static Result<std::unique_ptr<Run>> make(const RunOptions& options);
  ~Run();
  Result<Measurements> fly();
  const std::filesystem::path& dir() const { return dir_; }
  std::string planner_complaint() const;

 private:
  Run(const RunOptions& options, Mission mission, std::filesystem::path dir, DomainLock lock,
      ChannelChoice channel, std::uint32_t hubs)
      : options_(options),
        channel_(std::move(channel)),
        hubs_(hubs),
        mission_(std::move(mission)),
        dir_(std::move(dir)),
        lock_(std::move(lock)),
        events_(dir_ / shell::kEventsFile) {}

  Result<void> join();
  Result<void> act(const Action& action);
  Result<void> start(ProcessIndex process);
  void send(CommandKind kind);
  Result<std::string> change(const SceneChange& change);
  void serve(const ControlServer::Request& request, SteadyTime now);
  void reap(SteadyTime now);
  void read_bus();
  void serve_control(SteadyTime now);
  void show(SteadyTime now);

  RunOptions options_;
  ChannelChoice channel_;
  std::uint32_t hubs_;
  Mission mission_;
  std::filesystem::path dir_;
  DomainLock lock_;
  EventLog events_;
  Progress progress_;
  std::unique_ptr<link::DiscoveryServer> server_;  // none where hubs are the meeting place
  std::unique_ptr<link::Participant> participant_;
  link::ReaderPtr<link::StatusMessage> status_reader_;
  link::ReaderPtr<link::EventMessage> event_reader_;
  link::WriterPtr<link::CommandMessage> command_writer_;
  std::optional<ControlServer> control_;
  std::vector<ControlServer::ClientId> stopping_;  // clients who wait for a stop to be confirmed
  std::optional<SceneKeeper> scene_;
  std::optional<Supervisor> supervisor_;
  SwarmView view_;
  link::WireLimits limits_;
  link::RefusalCounters refused_;
  std::map<pid_t, ProcessIndex> children_;
  Measurements measurements_;
  std::vector<link::StatusMessage> statuses_;
  std::vector<link::EventMessage> heard_events_;
  SteadyTime shown_at_;
  int interrupts_seen_ = 0;
  std::uint32_t planner_starts_ = 0;
};

Result<std::unique_ptr<Run>> Run::make(const RunOptions& options) {
  if (const auto faults = parse_link_faults(options.fault); !faults) {
    return tl::unexpected(faults.error());
  }
  auto mission = load_mission(options.mission_file);
  if (!mission) return tl::unexpected(mission.error());
  if (options.robots) mission->robots.count = *options.robots;
  if (const auto places = place_robots(*mission, options.seed); !places) {
    return tl::unexpected(places.error());
  }
  const std::uint32_t agents =
      (mission->robots.count + options.per_process - 1) / options.per_process;
  auto channel = choose_channel({.wanted = options.channel,
                                 .agents = agents,
                                 .robots_per_process = options.per_process,
                                 .multicast = link::loopback_carries_multicast()});
  if (!channel) return tl::unexpected(channel.error());
  const std::uint32_t hubs = channel->channel == Channel::kGroups ? link::hubs_for(agents) : 0;
  auto lock = DomainLock::take(options.domain, link::participants_for({.hubs = hubs}, agents));
  if (!lock) return tl::unexpected(lock.error());
  const auto made = make_run_dir(options.out, mission->name);
  if (!made) return tl::unexpected(made.error());
  const std::filesystem::path& dir = *made;
  if (auto written = shell::write_file(dir / shell::kMissionFile, to_yaml(*mission)); !written) {
    return tl::unexpected(written.error());
  }
  auto run = std::unique_ptr<Run>(
      new Run(options, std::move(*mission), dir, std::move(*lock), std::move(*channel), hubs));
  if (const auto joined = run->join(); !joined) return tl::unexpected(joined.error());
  return run;
}

Run::~Run() {
  for (const auto& [pid, process] : children_) ::kill(pid, SIGKILL);
}

Result<void> Run::join() {
  link::Meeting meeting{.domain = lock_.domain(), .hubs = hubs_};
  if (hubs_ == 0) {
    auto server = link::make_discovery_server(lock_.domain(), 0);
    if (!server) return tl::unexpected(server.error());
    server_ = std::move(*server);
    meeting.server = server_->address();
  }
  if (auto written = shell::write_run_info(dir_, {.domain = meeting.domain,
                                                  .discovery_host = meeting.server.host,
                                                  .discovery_port = meeting.server.port,
                                                  .hubs = meeting.hubs,
                                                  .channel = channel_.channel,
                                                  .seed = options_.seed,
                                                  .began = utc_now()});
      !written) {
    return written;
  }
  auto participant = link::join_as_launcher(meeting);
  if (!participant) return tl::unexpected(participant.error());
  participant_ = std::move(*participant);
  auto status = participant_->make_reader(link::status_topic());
  auto event = participant_->make_reader(link::event_topic());
  auto command = participant_->make_writer(link::command_topic());
  auto scene = participant_->make_writer(link::scene_topic());
  if (!status) return tl::unexpected(status.error());
  if (!event) return tl::unexpected(event.error());
  if (!command) return tl::unexpected(command.error());
  if (!scene) return tl::unexpected(scene.error());
  status_reader_ = std::move(*status);
  event_reader_ = std::move(*event);
  command_writer_ = std::move(*command);
  scene_.emplace(mission_.world, dir_, std::move(*scene));
  auto control = ControlServer::listen(dir_);
  if (!control) return tl::unexpected(control.error());
  control_.emplace(std::move(*control));

  limits_ = link::wire_limits(mission_);
  supervisor_.emplace(SupervisorOptions{.robots = mission_.robots.count,
                                        .per_process = options_.per_process,
                                        .launcher = mission_.launcher,
                                        .script = mission_.script},
                      std::chrono::steady_clock::now());
  const std::string told =
      fmt::format("robot states go by {}: {}", to_string(channel_.channel), channel_.reason);
  events_.write(utc_now(), "launcher", link::Severity::kInfo, "channel", told);
  std::fprintf(stderr, "%s\n", told.c_str());
  view_ = SwarmView(mission_.robots.count, mission_.link.hear_radius_m);
  return {};
}

Result<void> Run::start(ProcessIndex process) {
  std::vector<std::string> command_line;
  std::string log;
  if (process == kPlanner) {
    command_line = {sibling_program("planner_service"), "--run", dir_.string(),
                    // A killed planner keeps the plan topic until its lease ends, unless its
                    // successor is stronger.
                    "--strength", fmt::format("{}", kPlannerStrength + planner_starts_++)};
    log = "planner.log";
  } else {
    const auto [first, count] = supervisor_->robots_of(process);
    command_line = {sibling_program("robot_agent"),
                    "--run",
                    dir_.string(),
                    "--ids",
                    fmt::format("{}", first.value()),
                    "--count",
                    fmt::format("{}", count),
                    "--number",
                    fmt::format("{}", process.value() - 1)};
    log = fmt::format("agent-{:05}.log", first.value());
  }
  if (!options_.fault.empty()) command_line.insert(command_line.end(), {"--fault", options_.fault});
  command_line.insert(command_line.end(), {"--parent", fmt::format("{}", ::getpid())});
  const auto pid = start_process(command_line, dir_ / shell::kLogsFolder / log);
  if (!pid) return tl::unexpected(pid.error());
  children_.emplace(*pid, process);
  return {};
}

void Run::send(CommandKind kind) {
  const std::int64_t stamp = utc_now().time_since_epoch().count();
  command_writer_->write(
      {.kind = kind, .command_id = static_cast<std::uint64_t>(stamp), .stamp_utc_ns = stamp});
}

Result<std::string> Run::change(const SceneChange& change) {
  const UtcTime now = utc_now();
  const std::string what = fmt::format("{} {}", name_of(change), keys_of(change));
  auto changed = scene_->change(change, now);
  if (!changed) {
    events_.write(now, "launcher", link::Severity::kWarning, "scene-refused",
                  fmt::format("{}: {}", what, changed.error().message));
    return changed;
  }
  if (std::holds_alternative<GoTo>(change)) supervisor_->on_new_goal(scene_->scene().version);
  events_.write(now, "launcher", link::Severity::kInfo, "scene", what);
  return changed;
}

Result<void> Run::act(const Action& action) {
  if (const auto* to_start = std::get_if<StartProcess>(&action)) return start(to_start->process);
  if (const auto* command = std::get_if<SendCommand>(&action)) {
    send(command->kind);
  } else if (const auto* scene = std::get_if<ChangeScene>(&action)) {
    if (const auto changed = change(scene->change); !changed) {
      progress_.say("the script's change was refused: " + changed.error().message);
    }
  } else if (const auto* signal = std::get_if<SignalProcess>(&action)) {
    for (const auto& [pid, process] : children_) {
      if (process == signal->process) ::kill(pid, number_of(signal->signal));
    }
  } else if (const auto* event = std::get_if<LogEvent>(&action)) {
    events_.write(utc_now(), "launcher",
                  event->warning ? link::Severity::kWarning : link::Severity::kInfo, event->code,
                  event->text);
    if (event->warning) progress_.say(event->text);
  }
  return {};
}

void Run::reap(SteadyTime now) {
  while (const auto child = reap_child()) {
    const auto known = children_.find(child->pid);
    if (known == children_.end()) continue;
    measurements_.cpu_s += child->cpu_s;
    measurements_.max_rss_mb = std::max(measurements_.max_rss_mb, child->max_rss_mb);
    supervisor_->on_exit(known->second, child->exit, now);
    children_.erase(known);
  }
}

void Run::read_bus() {
  participant_->receive();
  statuses_.clear();
  status_reader_->take(statuses_);
  for (const link::StatusMessage& status : statuses_) {
    if (const auto ok = link::check_status(status, limits_); !ok) {
      refused_.count(ok.error());
      continue;
    }
    view_.take(status);
    supervisor_->on_status(RobotId(status.robot_id),
                           {.has_plan = status.plan_version > 0,
                            .hears_neighbours = view_.hears_neighbours(status.robot_id),
                            .mode = status.mode,
                            .settled = status.settled,
                            .scene_version = status.plan_scene_version});
  }
  heard_events_.clear();
  event_reader_->take(heard_events_);
  for (const link::EventMessage& event : heard_events_) {
    if (const auto ok = link::check_event(event); !ok) {
      refused_.count(ok.error());
      continue;
    }
    events_.write(event);
  }
}

void Run::serve(const ControlServer::Request& request, SteadyTime now) {
  const std::size_t space = std::min(request.line.find(' '), request.line.size());
  const std::string word = request.line.substr(0, space);
  for (const CommandKind kind :
       {CommandKind::kStart, CommandKind::kPause, CommandKind::kResume, CommandKind::kStop}) {
    if (word != to_string(kind)) continue;
    supervisor_->on_command(kind, now);
    if (kind == CommandKind::kStop) {
      stopping_.push_back(request.client);
    } else {
      control_->answer(request.client,
                       fmt::format("done: {} sent to {} robots", word, command_writer_->matched()));
    }
    return;
  }
  const auto wanted = parse_scene_change(word, request.line.substr(space), mission_.world);
  const Result<std::string> changed = wanted ? change(*wanted) : tl::unexpected(wanted.error());
  control_->answer(request.client, changed ? "done: " + *changed
                                           : changed.error().message + "\nfailed: nothing changed");
}

void Run::serve_control(SteadyTime now) {
  for (const ControlServer::Request& request : control_->poll()) serve(request, now);
  if (stopping_.empty() || supervisor_->phase() != MissionPhase::kStopped) return;
  const auto unstopped = supervisor_->unstopped();
  if (!unstopped.empty() && supervisor_->stage() != Supervisor::Stage::kEnding) return;
  const std::string answer =
      unstopped.empty()
          ? fmt::format("done: {} robots confirmed the stop", supervisor_->counts().stopped)
          : "failed: stop not confirmed by robots " + describe(unstopped);
  for (const ControlServer::ClientId client : stopping_) control_->answer(client, answer);
  stopping_.clear();
}

void Run::show(SteadyTime now) {
  if (now - shown_at_ < std::chrono::milliseconds(250)) return;
  shown_at_ = now;
  const Supervisor::Counts c = supervisor_->counts();
  const std::uint32_t n = mission_.robots.count;
  progress_.show(headline_of(*supervisor_),
                 fmt::format("t {:.0f} s  ready {}/{}  arrived {}/{}  lost {}  {}",
                             supervisor_->mission_time(now).count(), c.ready, n, c.arrived, n,
                             c.lost, view_.describe(now)));
}

Result<Measurements> Run::fly() {
  while (supervisor_->stage() != Supervisor::Stage::kDone) {
    const SteadyTime now = std::chrono::steady_clock::now();
    for (; interrupts_seen_ < shell::stop_requests(); ++interrupts_seen_)
      supervisor_->on_interrupt();
    reap(now);
    read_bus();
    serve_control(now);
    for (const Action& action : supervisor_->step(now)) {
      if (auto done = act(action); !done) return tl::unexpected(done.error());
    }
    show(now);
    std::this_thread::sleep_for(kStep);
  }
  rusage own = {};
  ::getrusage(RUSAGE_SELF, &own);
  measurements_.cpu_s += static_cast<double>(own.ru_utime.tv_sec + own.ru_stime.tv_sec) +
                         1e-6 * static_cast<double>(own.ru_utime.tv_usec + own.ru_stime.tv_usec);
  measurements_.discovery_s = supervisor_->discovery_s();
  measurements_.hearing_s = supervisor_->hearing_s();
  measurements_.refused_by_launcher = refused_.total();
  measurements_.outcome = supervisor_->outcome();
  measurements_.channel = channel_.channel;
  return measurements_;
}

std::string Run::planner_complaint() const {
  return shell::read_file(dir_ / shell::kLogsFolder / "planner.log", 1U << 20U).value_or("");
}

}  // namespace

Result<ExitCode> run_mission(const RunOptions& options) {
  become_urgent();
  const auto run = Run::make(options);
  if (!run) return tl::unexpected(run.error());
  std::fprintf(stderr, "run directory: %s\n", (*run)->dir().c_str());
  const auto measured = (*run)->fly();
  if (!measured) return tl::unexpected(measured.error());
  if (measured->outcome == Outcome::kPlannerFailed) {
    std::fputs((*run)->planner_complaint().c_str(), stderr);
  }
  return summarise((*run)->dir(), *measured, options.json);
}

}  // namespace swarm::launcher
