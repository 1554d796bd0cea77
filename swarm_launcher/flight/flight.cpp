// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/flight.hpp"

#include <algorithm>
#include <cstdio>
#include <thread>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "swarm_core/app/run_dir.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarm_core/mission_file/scene_change_file.hpp"
#include "swarm_launcher/processes/child_process.hpp"
#include "swarm_launcher/processes/host_limits.hpp"
#include "swarm_link/monitor_topics.hpp"
#include "swarm_link/roles/run_meeting.hpp"
#include "swarm_link/udp_socket.hpp"
#include "swarm_link/vendor.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

// Period of the loop, and so the largest delay of a command by the launcher.
constexpr Duration kFlightStep = std::chrono::milliseconds(20);
// Ownership strength of the first planner; lower values are left to planners on stand-by.
constexpr std::uint32_t kPlannerStrength = 100;

// Refuses DDS implementations that the channel or this build does not support, before any process
// is started.
Result<void> vendors_fit(const FlightOptions& options, Channel channel) {
  const bool cyclone = options.how.agent_dds != AgentDds::kFastDds ||
                       options.how.cyclone_launcher || options.how.cyclone_planner ||
                       options.how.by_gateway > 0;
  if (cyclone && channel != Channel::kGroups) {
    return fail(ErrorCode::kBadInput,
                "Cyclone DDS joins without a discovery server; add --channel groups");
  }
  if (cyclone && !link::built_with(link::Vendor::kCycloneDds)) {
    return fail(ErrorCode::kBadInput, "this program was built without Cyclone DDS");
  }
  if (options.how.by_gateway > 0 && !link::built_with(link::Vendor::kFastDds)) {
    return fail(ErrorCode::kBadInput,
                "--by-gateway: the gateway speaks Fast DDS, which this program was built without");
  }
  return {};
}

}  // namespace

Flight::Flight(FlightOptions options, FlightObserver* observer, std::filesystem::path dir,
               link::DomainLock lock, ChannelChoice channel, std::uint32_t relays)
    : options_(std::move(options)),
      observer_(observer),
      channel_(std::move(channel)),
      relays_(relays),
      dir_(std::move(dir)),
      lock_(std::move(lock)),
      events_(dir_ / shell::kEventsFile) {}

// First everything that may be refused without side effects: faults, placement, options, channel.
// Then the domain, the run directory and the bus.
Result<std::unique_ptr<Flight>> Flight::make(FlightOptions options, FlightObserver* observer) {
  if (const auto faults = parse_link_faults(options.how.fault); !faults) {
    return tl::unexpected(faults.error());
  }
  // The agents place their robots themselves; this only finds out early whether that works.
  if (const auto places = place_robots(options.mission, options.how.seed); !places) {
    return tl::unexpected(places.error());
  }
  const std::uint32_t agents =
      (options.mission.robots.count + options.per_process - 1) / options.per_process;
  if (options.how.remote > 0 &&
      options.how.channel.value_or(Channel::kGroups) != Channel::kGroups) {
    return fail(ErrorCode::kBadInput, "--remote: robots of several hosts meet by --channel groups");
  }
  // Several hosts need static peers, which the groups channel uses: the discovery server is bound
  // to loopback.
  if (options.how.remote > 0) options.how.channel = Channel::kGroups;
  if (options.how.remote > options.mission.robots.count ||
      (options.how.remote > 0 &&
       (options.mission.robots.count - options.how.remote) % options.per_process != 0)) {
    return fail(ErrorCode::kBadInput,
                fmt::format("--remote {}: of {} robots that many must be there, and what is left "
                            "must be whole processes of {}",
                            options.how.remote, options.mission.robots.count, options.per_process));
  }
  // A build with Cyclone DDS only uses it for all processes.
  if (!link::built_with(link::Vendor::kFastDds)) {
    options.how.agent_dds = AgentDds::kCycloneDds;
    options.how.cyclone_launcher = options.how.cyclone_planner = true;
    if (!options.how.channel) options.how.channel = Channel::kGroups;
  }
  auto channel = choose_channel({.wanted = options.how.channel,
                                 .agents = agents,
                                 .robots_per_process = options.per_process,
                                 .multicast = link::carries_multicast(options.how.interface)});
  if (!channel) return tl::unexpected(channel.error());
  if (const auto fits = vendors_fit(options, channel->channel); !fits) {
    return tl::unexpected(fits.error());
  }
  const std::uint32_t relays = channel->channel == Channel::kGroups ? link::relays_for(agents) : 0;
  auto lock = link::DomainLock::take(options.how.domain,
                                     link::participants_for({.relays = relays}, agents));
  if (!lock) return tl::unexpected(lock.error());
  const auto dir = shell::make_run_dir(options.how.out, options.mission.name);
  if (!dir) return tl::unexpected(dir.error());
  if (auto written = shell::write_file(*dir / shell::kMissionFile, to_yaml(options.mission));
      !written) {
    return tl::unexpected(written.error());
  }
  auto flight = std::unique_ptr<Flight>(new Flight(std::move(options), observer, *dir,
                                                   std::move(*lock), std::move(*channel), relays));
  if (const auto joined = flight->join(); !joined) return tl::unexpected(joined.error());
  return flight;
}

// Only after an error are there children left: they must not outlive the launcher.
Flight::~Flight() {
  for (const auto& [pid, process] : children_) spawner_.signal(pid, EndSignal::kKill);
}

/// The endpoints of the launcher on the bus.
Result<void> Flight::open_endpoints() {
  auto status = participant_->make_reader(link::status_topic());
  auto event = participant_->make_reader(link::event_topic());
  auto command = participant_->make_writer(link::command_topic());
  auto scene = participant_->make_writer(link::scene_topic());
  if (!status) return tl::unexpected(status.error());
  if (!event) return tl::unexpected(event.error());
  if (!command) return tl::unexpected(command.error());
  if (!scene) return tl::unexpected(scene.error());
  inbox_.emplace(std::move(*status), std::move(*event), link::wire_limits(options_.mission));
  command_writer_ = std::move(*command);
  auto status_relay = participant_->make_writer(link::relayed_status_topic());
  auto event_relay = participant_->make_writer(link::relayed_event_topic());
  if (!status_relay) return tl::unexpected(status_relay.error());
  if (!event_relay) return tl::unexpected(event_relay.error());
  status_relay_ = std::move(*status_relay);
  event_relay_ = std::move(*event_relay);
  scene_.emplace(options_.mission.world, dir_, std::move(*scene));
  return {};
}

/// Reports which channel was chosen and why, and limits of this host that the run may exceed.
void Flight::report_channel(const shell::RunInfo& run) {
  const std::string text =
      fmt::format("robot states go by {}: {}", to_string(channel_.channel), channel_.reason);
  note(link::Severity::kInfo, "channel", text);
  std::fprintf(stderr, "%s\n", text.c_str());
  raise_open_files();
  for (const std::string& shortcoming : shortcomings(
           read_host_limits(),
           {.agents = run.agents, .robots_per_process = options_.per_process, .relays = relays_})) {
    note(link::Severity::kWarning, "host-limits", shortcoming);
    std::fprintf(stderr, "%s\n", shortcoming.c_str());
  }
}

// The run information is written before any process starts, because processes read from it how to
// join. The order of the rest: endpoints, control socket, supervisor, monitors, gateway.
Result<void> Flight::join() {
  link::DiscoveryAddress discovery_address;
  if (relays_ == 0) {
    auto server = link::make_discovery_server(lock_.domain(), 0);
    if (!server) return tl::unexpected(server.error());
    server_ = std::move(*server);
    discovery_address = server_->address();
  }
  const shell::RunInfo run{
      .domain = lock_.domain(),
      .discovery_host = discovery_address.host,
      .discovery_port = discovery_address.port,
      .agents = (options_.mission.robots.count + options_.per_process - 1) / options_.per_process,
      .relays = relays_,
      .cyclone_launcher = options_.how.cyclone_launcher,
      .cyclone_planner = options_.how.cyclone_planner,
      .host = options_.how.interface,
      .interface = options_.how.interface,
      .channel = channel_.channel,
      .seed = options_.how.seed,
      .began = utc_now()};
  if (auto written = shell::write_run_info(dir_, run); !written) return written;
  auto participant = link::join_as_launcher(link::meeting_of(run));
  if (!participant) return tl::unexpected(participant.error());
  participant_ = std::move(*participant);
  if (auto opened = open_endpoints(); !opened) return opened;
  auto control = shell::ControlServer::listen(dir_);
  if (!control) return tl::unexpected(control.error());
  control_.emplace(std::move(*control));

  supervisor_.emplace(
      SupervisorOptions{.robots = options_.mission.robots.count,
                        .per_process = options_.per_process,
                        .remote_processes =
                            (options_.how.remote + options_.per_process - 1) / options_.per_process,
                        .launcher = options_.mission.launcher,
                        .script = options_.mission.script},
      std::chrono::steady_clock::now());
  report_channel(run);
  reported_.resize(options_.mission.robots.count);
  view_ = SwarmView(options_.mission.robots.count, options_.mission.link.communication_radius_m);
  monitors_.emplace(options_.how.monitors, dir_);
  if (auto started = monitors_->start(); !started) return started;
  if (options_.how.by_gateway > 0) {
    gateway_.emplace(dir_);
    if (auto started = gateway_->start(); !started) return started;
  }
  return options_.how.remote > 0 ? open_to_hosts(run) : Result<void>{};
}

// Starts the planner or an agent process and remembers its pid. Which robots an agent process hosts
// follows from its index.
Result<void> Flight::start(ProcessIndex process) {
  std::vector<std::string> command_line;
  std::string log;
  if (process == kPlanner) {
    command_line = {program_or(options_.how.planner_program, "planner_service"), "--run",
                    dir_.string(),
                    // The topic of the plan belongs to a killed planner until its lease ends,
                    // unless its successor has a higher ownership strength.
                    "--strength", fmt::format("{}", kPlannerStrength + planner_starts_++)};
    log = "planner.log";
  } else {
    const auto [first, count] = supervisor_->robots_of(process);
    command_line = {program_or(options_.how.agent_program, "robot_agent"),
                    "--run",
                    dir_.string(),
                    "--ids",
                    fmt::format("{}", first.value()),
                    "--count",
                    fmt::format("{}", count),
                    "--number",
                    fmt::format("{}", process.value() - 1)};
    const bool by_gateway = process.value() <= options_.how.by_gateway;
    if (by_gateway || options_.how.agent_dds == AgentDds::kCycloneDds ||
        (options_.how.agent_dds == AgentDds::kHalf && process.value() % 2 == 0)) {
      command_line.insert(command_line.end(), {"--dds", "cyclonedds"});
    }
    if (by_gateway) command_line.emplace_back("--by-gateway");
    log = fmt::format("agent-{:05}.log", first.value());
  }
  if (!options_.how.fault.empty())
    command_line.insert(command_line.end(), {"--fault", options_.how.fault});
  command_line.insert(command_line.end(), {"--parent", fmt::format("{}", ::getpid())});
  const auto pid = spawner_.start(command_line, dir_ / shell::kLogsFolder / log);
  if (!pid) return tl::unexpected(pid.error());
  children_.emplace(*pid, process);
  return {};
}

// Changes the scene and logs it. The supervisor must know of a new goal, so that robots at the old
// one do not count as arrived.
Result<std::string> Flight::change(const SceneChange& change) {
  const UtcTime now = utc_now();
  const std::string what = fmt::format("{} {}", name_of(change), keys_of(change));
  auto changed = scene_->change(change, now);
  if (!changed) {
    note(link::Severity::kWarning, "scene-refused",
         fmt::format("{}: {}", what, changed.error().message));
    return changed;
  }
  if (std::holds_alternative<GoTo>(change)) supervisor_->on_new_goal(scene_->scene().version);
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
    if (hosts_) hosts_->end(signal->process, signal->signal);
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
    if (hosts_) hosts_->on_user_command(kind);
    if (kind == CommandKind::kStop) {
      stopping_.push_back(request.client);
    } else {
      control_->answer(request.client,
                       fmt::format("done: {} sent to {} robots", word, command_writer_->matched()));
    }
    return;
  }
  auto wanted = parse_scene_change(word, request.line.substr(space), options_.mission.world);
  if (wanted && std::holds_alternative<AddBody>(*wanted)) {
    wanted = fail(ErrorCode::kBadInput, "add_body: the launcher alone adds bodies");
  }
  const Result<std::string> changed = wanted ? change(*wanted) : tl::unexpected(wanted.error());
  control_->answer(request.client, changed ? "done: " + *changed
                                           : changed.error().message + "\nfailed: nothing changed");
}

// Answers waiting stop requests: when no robot is left that has not confirmed, or when the
// supervisor gives up and ends the run.
void Flight::serve_control(SteadyTime now) {
  for (const shell::ControlServer::Request& request : control_->poll()) serve(request, now);
  if (stopping_.empty() || supervisor_->phase() != MissionPhase::kStopped) return;
  const auto unstopped = supervisor_->unstopped();
  if (!unstopped.empty() && supervisor_->stage() != Supervisor::Stage::kEnding) return;
  const std::string answer =
      unstopped.empty()
          ? fmt::format("done: {} robots confirmed the stop", supervisor_->counts().stopped)
          : "failed: stop not confirmed by robots " + describe(unstopped);
  for (const shell::ControlServer::ClientId client : stopping_) control_->answer(client, answer);
  stopping_.clear();
}

// Four times a second: more often is hard to read, and describe() sums over all robots.
void Flight::show(SteadyTime now) {
  if (now - shown_at_ < std::chrono::milliseconds(250)) return;
  shown_at_ = now;
  const Supervisor::Counts c = supervisor_->counts();
  const std::uint32_t n = options_.mission.robots.count;
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
    if (hosts_) {
      for (const LogEvent& event : hosts_->step(*supervisor_, now)) log(event);
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
  measurements_.refused_by_launcher = inbox_->refused().total();
  measurements_.outcome = supervisor_->outcome();
  measurements_.channel = channel_.channel;
  return measurements_;
}

std::string Flight::planner_complaint() const {
  return shell::read_file(dir_ / shell::kLogsFolder / "planner.log", 1U << 20U).value_or("");
}

}  // namespace swarm::launcher
