// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/flight_loop.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/one_line.hpp"
#include "swarm_core/mission_file/scene_change_file.hpp"
#include "swarm_launcher/flight/process_commands.hpp"
#include "swarm_link/messages.hpp"

namespace swarm::launcher {
namespace {

// More often is hard to read, and describing the swarm sums over all robots.
constexpr Duration kShowEvery = std::chrono::milliseconds(250);
// Exit code of a process that could not be started, as a shell has it.
constexpr int kNotStarted = 127;

SupervisorOptions supervision_of(const FlightOptions& options) {
  return {.robots = options.mission.robots.count,
          .per_process = options.per_process,
          .remote_processes = (options.how.remote + options.per_process - 1) / options.per_process,
          .launcher = options.mission.launcher,
          .script = options.mission.script,
          .agent_silence = SilenceLimits::of(options.mission.link.status_hz),
          .planner_silence = SilenceLimits::of(options.mission.timing.heartbeat_hz)};
}

}  // namespace

FlightLoop::FlightLoop(const FlightOptions& options, const std::filesystem::path& dir,
                       FlightPorts ports, SteadyTime now)
    : options_(options),
      dir_(dir),
      ports_(std::move(ports)),
      supervisor_(supervision_of(options), now),
      view_(options.mission.robots.count, options.mission.link.communication_radius_m),
      late_(options.mission.robots.count, options.mission.link.status_hz),
      fallen_(options.mission, ports_.scene, ports_.log,
              {.robots = options.mission.robots.count - options.how.remote,
               .log_delay = robot_log::log_delay(
                   options.per_process, from_seconds(1.0 / options.mission.control.rate_hz)),
               .runs_for = [this](RobotId robot,
                                  SteadyTime at) { return supervisor_.runs_for(robot, at); }},
              ports_.recorded),
      stamp_tolerance_(from_seconds(options.mission.timing.clock_skew_warn_s)),
      clock_skew_refuse_(from_seconds(options.mission.timing.clock_skew_refuse_s)),
      confirmations_(options.mission.robots.count, stamp_tolerance_) {}

FlightLoop::~FlightLoop() {
  for (const auto& [pid, process] : children_) ports_.spawner.signal(pid, EndSignal::kKill);
}

// Ended children, bus, other hosts and requests come first; then the supervisor decides on what
// they reported, and its actions are executed.
Result<void> FlightLoop::step(const FlightTime& now) {
  reap(now);
  read_bus(now);
  report_refusals(now);
  overrule(now);
  if (ports_.hosts != nullptr) {
    for (const LogEvent& event : ports_.hosts->step(supervisor_, now.steady)) {
      ports_.log.log(now.utc, event);
    }
    for (const ProcessIndex process : ports_.hosts->take_ended()) release(process, now.utc);
  }
  serve_requests(now);
  for (const Action& action : supervisor_.step(now.steady)) {
    if (auto done = act(action, now); !done) return done;
  }
  fallen_.update(now);
  send_stop(now);
  for (const LogEvent& event : ports_.helpers.step(now.steady)) ports_.log.log(now.utc, event);
  if (ports_.beats != nullptr) {
    const bool lists_all = supervisor_.knows_silent(now.steady) && is_gateway_matched(now.steady);
    ports_.beats->step(now, supervisor_, late_, lists_all);
  }
  if (const auto message = ports_.helpers.message()) ports_.display.print(*message);
  if (ports_.observer != nullptr) ports_.observer->on_step(*this, now.steady);
  show(now.steady);
  return {};
}

/// Whether the gateway, if there is one, receives all robots behind it that the launcher receives.
/// Otherwise robots that do not receive each other may be near each other although both are well.
bool FlightLoop::is_gateway_matched(SteadyTime now) const {
  if (options_.how.by_gateway == 0) return true;
  const std::uint32_t behind =
      std::min(options_.how.by_gateway * options_.per_process, options_.mission.robots.count);
  std::uint32_t received = 0;
  for (std::uint32_t i = 0; i < behind; ++i) {
    received += supervisor_.is_received(RobotId(i), now) ? 1 : 0;
  }
  return ports_.helpers.robots_of_gateway() >= received;
}

// Children that are neither planner nor agent are helpers.
void FlightLoop::reap(const FlightTime& now) {
  while (const auto child = ports_.spawner.reap()) {
    const auto known = children_.find(child->pid);
    if (known == children_.end()) {
      if (const auto event = ports_.helpers.on_exit(child->pid, now.steady)) {
        ports_.log.log(now.utc, *event);
        if (event->code == kRecorderExit) ports_.log.add_loss("recording of the bus: its end");
      }
      continue;
    }
    measurements_.cpu_s += child->cpu_s;
    measurements_.max_rss_mb = std::max(measurements_.max_rss_mb, child->max_rss_mb);
    const auto [first, count] = supervisor_.robots_of(known->second);
    const bool is_planner = known->second == kPlanner;
    if (child->exit.signal != 0) {  // otherwise it has reported what it could not write
      ports_.log.on_killed(is_planner ? link::kPlannerSource : first.value(),
                           is_planner ? 1 : count);
    }
    supervisor_.on_exit(known->second, child->exit, now.steady);
    release(known->second, now.utc);
    children_.erase(known);
  }
}

// The next process of these robots reports from another sender.
void FlightLoop::release(ProcessIndex process, UtcTime now) {
  const auto [first, count] = supervisor_.robots_of(process);
  for (std::uint32_t i = 0; i < count; ++i) {
    ports_.bus.inbox.release_status(RobotId(first.value() + i), now);
  }
}

// Everything that fails here is logged, except for the start of a process before the mission: one
// in flight counts as an end of that process, which is tried again.
Result<void> FlightLoop::act(const Action& action, const FlightTime& now) {
  if (const auto* to_start = std::get_if<StartProcess>(&action)) {
    const auto started = start(to_start->process);
    if (started || supervisor_.stage() != Supervisor::Stage::kRunning) return started;
    ports_.log.log(now.utc, LogEvent{.warning = true,
                                     .code = "start-failed",
                                     .text = one_line(started.error().message)});
    supervisor_.on_exit(to_start->process, {.code = kNotStarted}, now.steady);
    return {};
  }
  if (const auto* command = std::get_if<SendCommand>(&action)) {
    send(command->kind, now.utc);
  } else if (const auto* scene = std::get_if<ChangeScene>(&action)) {
    if (const auto changed = change(scene->change, now.utc); !changed) {
      ports_.display.print("the script's change was refused: " + changed.error().message);
    }
  } else if (const auto* to_signal = std::get_if<SignalProcess>(&action)) {
    signal(*to_signal);
  } else if (const auto* fallen = std::get_if<AddBodies>(&action)) {
    fallen_.add(fallen->robots, now);
  } else if (const auto* risen = std::get_if<ClearBodies>(&action)) {
    fallen_.clear(risen->robots, now.utc);
  } else if (const auto* event = std::get_if<LogEvent>(&action)) {
    ports_.log.log(now.utc, *event);
  }
  return {};
}

// Starts the planner or an agent process and remembers its pid. Which robots an agent process hosts
// follows from its index.
Result<void> FlightLoop::start(ProcessIndex process) {
  const auto [first, count] = supervisor_.robots_of(process);
  ProcessCommand command = process == kPlanner
                               ? planner_command(options_.how, dir_)
                               : agent_command(options_.how, dir_, process, first, count);
  if (!ports_.inputs.empty()) {
    command.line.insert(command.line.end(), {"--inputs", ports_.inputs});
  }
  if (process != kPlanner && !ports_.steps.empty()) {
    command.line.insert(command.line.end(), {"--steps", ports_.steps});
  }
  const auto pid = ports_.spawner.start(command.line, command.log);
  if (!pid) return tl::unexpected(pid.error());
  children_.emplace(*pid, process);
  return {};
}

void FlightLoop::signal(const SignalProcess& action) {
  for (const auto& [pid, process] : children_) {
    if (process == action.process) ports_.spawner.signal(pid, action.signal);
  }
  if (ports_.hosts != nullptr) ports_.hosts->end(action.process, action.signal);
}

// The UTC time serves as the command's id, so ids increase also after a restart of the launcher.
// Two commands of one step have the same time; robots refuse an id that they know, so the second
// one has the next. A stop passes whatever its id is; a repeated one keeps it, as robots confirm
// it.
void FlightLoop::send(CommandKind kind, UtcTime now) {
  SentCommand command{.kind = kind};
  if (kind == CommandKind::kStop && stop_) {
    command = *stop_;
  } else {
    command.stamp = now;
    command.id = static_cast<std::uint64_t>(now.time_since_epoch().count());
    if (kind != CommandKind::kStop) {
      command.id = std::max(last_command_id_ + 1, command.id);
      last_command_id_ = command.id;
    }
    confirmations_.on_sent(command);
  }
  if (kind == CommandKind::kStop) stop_ = command;
  ports_.bus.commands->write({.kind = kind,
                              .command_id = command.id,
                              .stamp_utc_ns = command.stamp.time_since_epoch().count()});
}

// Beside the command's reliable topic, which on a lossy network may be late, and until the last
// process has ended. The same stop, so that robots confirm it by either path.
void FlightLoop::send_stop(const FlightTime& now) {
  if (ports_.stop == nullptr || supervisor_.phase() != MissionPhase::kStopped) return;
  ports_.stop->step(now.steady, stop_ ? stop_->stamp : now.utc);
  for (const RobotId robot : ports_.stop->newly_confirmed()) supervisor_.on_stop_confirmed(robot);
}

// Changes the scene and logs it. The supervisor must know of a new goal, so that robots at the old
// one do not count as arrived.
Result<std::string> FlightLoop::change(const SceneChange& change, UtcTime now) {
  const std::string what = fmt::format("{} {}", name_of(change), keys_of(change));
  auto changed = ports_.scene.change(change, now);
  if (!changed) {
    ports_.log.note(now, link::Severity::kWarning, "scene-refused",
                    fmt::format("{}: {}", what, changed.error().message));
    return changed;
  }
  if (std::holds_alternative<GoTo>(change)) {
    supervisor_.on_new_goal(ports_.scene.scene().version);
  }
  if (const auto* clear = std::get_if<ClearBody>(&change)) supervisor_.on_cleared(clear->robot);
  ports_.log.note(now, link::Severity::kInfo, "scene", what);
  return changed;
}

void FlightLoop::show(SteadyTime now) {
  if (now - shown_at_ < kShowEvery) return;
  shown_at_ = now;
  const Supervisor::Counts c = supervisor_.counts();
  const std::uint32_t n = options_.mission.robots.count;
  std::string details = fmt::format("t {:.0f} s  ready {}/{}  arrived {}/{}  lost {}  {}",
                                    supervisor_.mission_time(now).count(), c.ready, n, c.arrived, n,
                                    c.lost, view_.describe(now));
  if (ports_.observer != nullptr) details += "  " + ports_.observer->describe();
  ports_.display.show(headline_of(supervisor_), details);
}

Measurements FlightLoop::measurements() const {
  Measurements m = measurements_;
  m.outcome = supervisor_.outcome();
  m.discovery_s = supervisor_.discovery_s();
  m.neighbour_discovery_s = supervisor_.neighbour_discovery_s();
  m.refused_by_launcher = ports_.bus.inbox.refused().total();
  return m;
}

}  // namespace swarm::launcher
