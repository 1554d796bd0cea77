// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/supervisor.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace swarm::launcher {
namespace {

// An emergency stop is sent 15 times within 1.5 s, because it must get through a degraded network.
constexpr Duration kStopRepeat = std::chrono::milliseconds(100);
constexpr std::uint32_t kStopRepeats = 15;
// Longest wait for the robots' confirmations.
constexpr Duration kStopTimeout = std::chrono::seconds(5);
/// At the edge of a dense goal a robot may be pushed out again, so all robots must stay arrived for
/// this long.
constexpr Duration kStay = std::chrono::seconds(2);
/// In a dense region arrived robots may never come to rest; then this time is enough.
constexpr Duration kConvergeTimeout = std::chrono::seconds(10);

std::uint32_t process_count(const SupervisorOptions& options) {
  return 1 + (options.robots + options.per_process - 1) / options.per_process;
}

}  // namespace

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kNone:
      return "running";
    case Outcome::kCompleted:
      return "completed";
    case Outcome::kTimeLimit:
      return "time_limit";
    case Outcome::kQuorumTimeout:
      return "quorum_timeout";
    case Outcome::kPlannerFailed:
      return "planner_failed";
    case Outcome::kStopped:
      return "stopped";
    case Outcome::kInterrupted:
      return "interrupted";
    case Outcome::kAllLost:
      return "all_lost";
  }
  return "unknown";
}

// Joins consecutive ids to ranges.
std::string describe(const std::vector<RobotId>& robots) {
  constexpr std::size_t kRanges = 20;  // readable, and short enough for an event's text
  std::string text;
  std::size_t ranges = 0;
  for (std::size_t i = 0; i < robots.size(); ++ranges) {
    if (ranges == kRanges) return text + fmt::format(" and {} more", robots.size() - i);
    std::size_t j = i;
    while (j + 1 < robots.size() && robots[j + 1].value() == robots[j].value() + 1) ++j;
    text += text.empty() ? "" : ", ";
    text += j == i ? fmt::format("{}", robots[i].value())
                   : fmt::format("{}-{}", robots[i].value(), robots[j].value());
    i = j + 1;
  }
  return text;
}

Supervisor::Supervisor(const SupervisorOptions& options, SteadyTime now)
    : options_(options),
      processes_(process_count(options)),
      robots_(options.robots),
      begun_(now),
      last_start_(now) {}

std::pair<RobotId, std::uint32_t> Supervisor::robots_of(ProcessIndex process) const {
  if (process == kPlanner) return {RobotId(0), 0};
  const std::uint32_t first = (process.value() - 1) * options_.per_process;
  return {RobotId(first), std::min(options_.per_process, options_.robots - first)};
}

// A status that a process sent before it ended may arrive after its end was noticed.
void Supervisor::on_status(RobotId robot, const RobotReport& report) {
  Robot& r = robots_.at(robot.value());
  Process& process = process_of(robot);
  const bool is_late = r.silent_since && report.sent_at <= *r.silent_since;
  if (is_late && !r.received && !r.absent) return;
  r.report = report;
  r.has_stopped = r.has_stopped || report.confirms_stop;
  r.received = true;
  r.cleared = false;
  process.silence.on_received();
  if (std::exchange(r.absent, false)) late_joiners_.push_back(robot);
  if (!r.silent_since || is_late) return;
  r.silent_since.reset();
  std::erase(fallen_, robot);
  risen_.push_back(robot);
}

// Falling and rising within one step cancel each other: the last one counts.
void Supervisor::on_silent(RobotId robot, SteadyTime now) {
  Robot& r = robots_.at(robot.value());
  r.silent_since = now;
  r.cleared = false;
  std::erase(risen_, robot);
  if (std::find(fallen_.begin(), fallen_.end(), robot) == fallen_.end()) fallen_.push_back(robot);
}

// Queued until the next step, which decides with all commands in their order.
void Supervisor::on_command(CommandKind kind, SteadyTime now) {
  if (kind == CommandKind::kStop && phase_ != MissionPhase::kStopped)
    stop_ends_ = now + kStopTimeout;
  pending_commands_.push_back(kind);
}

void Supervisor::on_interrupt() { ++interrupts_; }

// Applies a command to the phase and sends it. A stop is sent repeatedly by repeat_stop() instead.
void Supervisor::command(CommandKind kind, SteadyTime now, std::vector<Action>& actions) {
  const MissionPhase before = phase_;
  phase_ = phase_after(phase_, kind);
  if (before == MissionPhase::kReady && phase_ == MissionPhase::kRunning) started_at_ = now;
  if (phase_ == MissionPhase::kStopped && before != MissionPhase::kStopped) {
    stops_to_send_ = kStopRepeats;
    next_stop_ = now;
    stop_ends_ = now + kStopTimeout;
  } else {
    actions.emplace_back(SendCommand{kind});
  }
  actions.emplace_back(LogEvent{.code = "command", .text = std::string(swarm::to_string(kind))});
}

/// One change of the scene per step for any number of robots, because each change causes a new
/// plan.
void Supervisor::keep_bodies(std::vector<Action>& actions) {
  if (!fallen_.empty()) actions.emplace_back(AddBodies{std::exchange(fallen_, {})});
  if (!risen_.empty()) actions.emplace_back(ClearBodies{std::exchange(risen_, {})});
}

// Starts the mission when all robots are ready. After the quorum time-out it starts with those that
// are ready, if they are enough; otherwise the run ends.
void Supervisor::gather(SteadyTime now, std::vector<Action>& actions) {
  const auto is_known = [](const Robot& r) { return r.received && r.report.has_plan; };
  const bool discovered = std::ranges::all_of(robots_, is_known);
  std::vector<RobotId> missing;
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    Robot& r = robots_[i];
    r.received_neighbours |= discovered && r.report.receives_neighbours;
    const bool has_neighbours = r.received_neighbours || r.report.receives_neighbours;
    if (!is_known(r) || !has_neighbours) missing.emplace_back(i);
  }
  const double waited_s = to_seconds(now - last_start_);
  if (discovered && discovery_s_ < 0.0) discovery_s_ = waited_s;
  if (missing.empty()) {
    neighbour_discovery_s_ = waited_s - discovery_s_;
  } else {
    if (waited_s < options_.launcher.quorum_timeout_s) return;
    const double ready = static_cast<double>(robots_.size() - missing.size());
    const bool enough =
        ready >= options_.launcher.quorum_share * static_cast<double>(robots_.size());
    actions.emplace_back(LogEvent{
        .warning = true,
        .code = "quorum",
        .text = fmt::format("{} of {} robots are not ready after {} s: {}{}", missing.size(),
                            robots_.size(), options_.launcher.quorum_timeout_s, describe(missing),
                            hindrances_of(missing))});
    if (!enough) {
      begin_ending(Outcome::kQuorumTimeout, now);
      return;
    }
  }
  leave_out_absent(now);
  stage_ = Stage::kRunning;
  command(CommandKind::kStart, now, actions);
}

// What the processes of missing robots reported: robots by reason.
std::string Supervisor::hindrances_of(const std::vector<RobotId>& missing) const {
  std::map<std::string, std::vector<RobotId>> robots;
  for (const RobotId robot : missing) {
    const std::uint32_t first = robot.value() - robot.value() % options_.per_process;
    if (const std::string& why = robots_[first].hindrance; !why.empty()) {
      robots[why].push_back(robot);
    }
  }
  std::string text;
  for (const auto& [why, hindered] : robots)
    text += fmt::format("; {}: {}", describe(hindered), why);
  return text;
}

// A delayed step sends at most two repetitions, so that overdue ones do not come as a burst.
void Supervisor::repeat_stop(SteadyTime now, std::vector<Action>& actions) {
  while (stops_to_send_ > 0 && now >= next_stop_) {
    actions.emplace_back(SendCommand{CommandKind::kStop});
    --stops_to_send_;
    next_stop_ = std::max(next_stop_ + kStopRepeat, now);
  }
}

// Executes the events of the script whose time has come, in their order.
void Supervisor::play_script(SteadyTime now, std::vector<Action>& actions) {
  const double t = mission_time(now).count();
  while (next_script_ < options_.script.size() && options_.script[next_script_].at_s <= t) {
    const MissionAction& action = options_.script[next_script_++].action;
    if (const auto* kind = std::get_if<CommandKind>(&action)) {
      command(*kind, now, actions);
    } else {
      actions.emplace_back(ChangeScene{std::get<SceneChange>(action)});
    }
  }
}

/// Whether the script contains a later goal: then arrival is not the end of the mission.
bool Supervisor::script_moves_on() const {
  return std::any_of(options_.script.begin() + static_cast<std::ptrdiff_t>(next_script_),
                     options_.script.end(), [](const ScriptEvent& event) {
                       const auto* change = std::get_if<SceneChange>(&event.action);
                       return change != nullptr && std::holds_alternative<GoTo>(*change);
                     });
}

// Ends the mission: after a stop that all robots confirmed, when no robot is left, when all have
// settled or have been arrived for long enough, or at the time limit.
void Supervisor::run(SteadyTime now, std::vector<Action>& actions) {
  if (phase_ == MissionPhase::kStopped) {
    const bool confirmed = stops_to_send_ == 0 && unstopped().empty();
    if (!confirmed && now < stop_ends_) return;
    if (!confirmed) {
      actions.emplace_back(LogEvent{.warning = true,
                                    .code = "stop-unconfirmed",
                                    .text = "not confirmed by " + describe(unstopped())});
    }
    begin_ending(Outcome::kStopped, now);
    return;
  }
  // Evaluated before the script is played: reports of arrival at a goal that is only now published
  // cannot exist yet.
  const bool had_goals_left = script_moves_on();
  play_script(now, actions);
  const Counts c = counts();
  const std::uint32_t living = options_.robots - c.lost;
  if (living == 0) {
    begin_ending(Outcome::kAllLost, now);
    return;
  }
  const bool arrived = c.arrived == living && !had_goals_left;
  if (arrived && !all_arrived_) all_arrived_at_ = now;
  all_arrived_ = arrived;
  const Duration stayed = arrived ? now - all_arrived_at_ : Duration::zero();
  if ((c.settled == living && stayed >= kStay) || stayed > kConvergeTimeout) {
    begin_ending(Outcome::kCompleted, now);
  } else if (mission_time(now).count() > options_.launcher.time_limit_s) {
    begin_ending(Outcome::kTimeLimit, now);
  }
}

// The first reason counts. From now on no process is restarted.
void Supervisor::begin_ending(Outcome outcome, SteadyTime now) {
  if (stage_ == Stage::kEnding || stage_ == Stage::kDone) return;
  stage_ = Stage::kEnding;
  outcome_ = outcome;
  ending_since_ = now;
  for (Process& p : processes_) p.respawn_due = false;
}

// Signals all processes that still run, with SIGINT, then SIGTERM, then SIGKILL, each a grace
// period later; a second interrupt of the user goes to SIGKILL at once.
void Supervisor::end(SteadyTime now, std::vector<Action>& actions) {
  const bool all_gone =
      std::none_of(processes_.begin(), processes_.end(), [](const Process& p) { return p.alive; });
  if (all_gone) {
    stage_ = Stage::kDone;
    return;
  }
  const auto timeout = now - ending_since_;
  std::uint32_t due = 1 + static_cast<std::uint32_t>(timeout / options_.signal_grace);
  if (interrupts_ > 1) due = 3;
  due = std::min(due, 3U);
  if (signals_sent_ >= due) return;
  signals_sent_ = due;
  constexpr EndSignal kLadder[] = {EndSignal::kInterrupt, EndSignal::kTerminate, EndSignal::kKill};
  for (std::uint32_t i = 0; i < processes(); ++i) {
    if (processes_[i].alive) actions.emplace_back(SignalProcess{ProcessIndex(i), kLadder[due - 1]});
  }
}

// Commands of the user are applied before the stage is advanced, so that an emergency stop works in
// every stage up to the ending.
std::vector<Action> Supervisor::step(SteadyTime now) {
  std::vector<Action> actions;
  if (interrupts_ > 0) begin_ending(Outcome::kInterrupted, now);
  for (LogEvent& event : std::exchange(pending_log_, {})) actions.emplace_back(std::move(event));
  if (stage_ == Stage::kEnding) {
    end(now, actions);
    return actions;
  }
  if (stage_ == Stage::kDone) return actions;
  keep_bodies(actions);
  report_late_joiners(actions);
  watch_silence(now, actions);
  for (const CommandKind kind : std::exchange(pending_commands_, {})) command(kind, now, actions);
  repeat_stop(now, actions);
  if (phase_ != MissionPhase::kStopped) start_due(now, actions);
  if (phase_ == MissionPhase::kStopped) stage_ = Stage::kRunning;
  if (stage_ == Stage::kStarting && next_start_ == local_processes()) stage_ = Stage::kGathering;
  if (stage_ == Stage::kGathering) gather(now, actions);
  if (stage_ == Stage::kRunning) run(now, actions);
  return actions;
}

// Arrived and settled count only for the newest goal.
Supervisor::Counts Supervisor::counts() const {
  Counts c;
  for (const Process& p : processes_) c.started += p.started ? 1 : 0;
  for (const Robot& r : robots_) {
    if (is_out(r)) {
      ++c.lost;
      continue;
    }
    c.ready += r.received && r.report.has_plan && r.report.receives_neighbours ? 1 : 0;
    c.arrived +=
        r.report.mode == RobotMode::kArrived && !r.has_stopped && has_newest_goal(r) ? 1 : 0;
    c.settled += r.report.settled && has_newest_goal(r) ? 1 : 0;
    c.stopped += r.has_stopped ? 1 : 0;
  }
  return c;
}

// A robot whose process has ended or hangs since its start cannot confirm; its driver stops it
// without commands.
std::vector<RobotId> Supervisor::unstopped() const {
  std::vector<RobotId> out;
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    const bool runs = process_of(RobotId(i)).alive && !robots_[i].lost && !robots_[i].absent;
    if (runs && !robots_[i].has_stopped) out.emplace_back(i);
  }
  return out;
}

std::vector<RobotId> Supervisor::lost() const {
  std::vector<RobotId> out;
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    if (is_out(robots_[i])) out.emplace_back(i);
  }
  return out;
}

std::vector<RobotId> Supervisor::silent() const {
  std::vector<RobotId> out;
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    const Robot& robot = robots_[i];
    if (!robot.cleared && (!robot.received || robot.silent_since)) out.emplace_back(i);
  }
  return out;
}

MissionTime Supervisor::mission_time(SteadyTime now) const {
  return phase_ == MissionPhase::kReady || started_at_ == SteadyTime{}
             ? MissionTime{0}
             : MissionTime(now - started_at_);
}

}  // namespace swarm::launcher
