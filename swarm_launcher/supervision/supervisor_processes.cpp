// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The life of the processes under the supervisor: start, end, restart.
#include <utility>

#include <fmt/format.h>

#include "swarm_core/mission/supervision_times.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {
namespace {

// A process that has not been received after this time no longer delays the next starts.
constexpr Duration kStartTimeout = std::chrono::seconds(5);

std::string describe(const ProcessExit& exit) {
  return exit.signal != 0 ? fmt::format("killed by signal {}", exit.signal)
                          : fmt::format("ended with code {}", exit.code);
}

}  // namespace

// Its robots may have been given up when an earlier host left.
void Supervisor::on_joined(ProcessIndex first, std::uint32_t count, SteadyTime now) {
  for (std::uint32_t i = first.value(); i < first.value() + count; ++i) {
    Process& p = processes_.at(i);
    p.alive = p.started = true;
    p.started_at = now;
    p.silence.on_start(now);
    const auto [robot, robots] = robots_of(ProcessIndex(i));
    for (std::uint32_t r = robot.value(); r < robot.value() + robots; ++r) robots_[r].lost = false;
  }
}

// In this order: the run is ending; a remote process before the start, which another host may
// replace; a remote process that its host restarts; restart; given up. What the robots of the
// process reported does not hold any more.
void Supervisor::on_exit(ProcessIndex process, const ProcessExit& exit, SteadyTime now) {
  Process& p = processes_.at(process.value());
  p.alive = false;
  if (stage_ == Stage::kEnding || stage_ == Stage::kDone) return;
  const auto [first, count] = robots_of(process);
  for (std::uint32_t r = first.value(); r < first.value() + count; ++r) {
    robots_[r].received = false;
    robots_[r].report = {};
    robots_[r].received_neighbours = false;
    robots_[r].has_stopped = false;
    robots_[r].hindrance.clear();
  }
  if (exit.is_restarted) {
    p.alive = true;
    p.silence.on_start(now);
  }
  if (is_remote(process) && stage_ != Stage::kRunning) {
    p.started = exit.is_restarted;
    return;
  }
  if (process == kPlanner) ended_epoch_ = planner_epoch_;

  for (std::uint32_t i = 0; i < count; ++i) on_silent(RobotId(first.value() + i), now);
  const bool is_planner = process == kPlanner;
  const std::string who = is_planner ? "planner" : fmt::format("agent process {}", process.value());
  pending_log_.push_back({.warning = true,
                          .code = is_planner ? "planner-exit" : "agent-exit",
                          .text = fmt::format("{} {}", who, describe(exit))});
  if (exit.is_restarted) return;
  // These exit codes mean that planning itself failed: a restart would fail in the same manner.
  const bool hopeless = is_planner && exit.signal == 0 &&
                        (exit.code == static_cast<int>(ExitCode::kCriteriaNotMet) ||
                         exit.code == static_cast<int>(ExitCode::kUsage));
  const Duration silence = p.is_killed ? p.silence.silent_for(now) : Duration::zero();
  const Duration delay = p.restarts.on_exit(now, silence);
  const std::uint32_t allowed =
      is_planner ? options_.launcher.respawn_planner_max : options_.launcher.respawn_agent_max;
  const bool is_spent = p.restarts.deaths_in_a_row() > allowed;
  const bool is_needed = is_planner && stage_ == Stage::kRunning;
  if (!hopeless && !is_remote(process) && (!is_spent || is_needed)) {
    p.respawn_due = true;
    p.respawn_at = now + delay;
    if (is_spent) hold_without_planner(p.restarts.deaths_in_a_row());
    return;
  }
  if (is_needed) {
    hold_without_planner(0);
    return;
  }
  if (is_planner) {
    begin_ending(Outcome::kPlannerFailed, now);
    return;
  }
  for (std::uint32_t i = 0; i < count; ++i) robots_[first.value() + i].lost = true;
}

// Robots that were absent when the mission started, or had been given up.
void Supervisor::report_late_joiners(std::vector<Action>& actions) {
  if (late_joiners_.empty()) return;
  actions.emplace_back(LogEvent{.code = "late-joiners",
                                .text = "robots that were absent report: " +
                                        launcher::describe(std::exchange(late_joiners_, {}))});
}

// Robots without a planner hold by themselves: ending their processes would not be safer.
void Supervisor::hold_without_planner(std::uint32_t deaths) {
  pending_log_.push_back(
      {.warning = true,
       .code = "planner-given-up",
       .text = deaths == 0 ? "the planner cannot plan any more: the robots hold"
                           : fmt::format("the planner ended {} times in a row: the robots hold "
                                         "until a restart helps",
                                         deaths)});
}

/// Whether an agent process has been started and is not received yet. Dozens of such processes
/// compete for the CPU with each other and with those that answer their discovery. A process that
/// hangs stops counting after a while, so that it does not block the others.
bool Supervisor::is_starting(std::uint32_t process, SteadyTime now) const {
  const Process& p = processes_[process];
  return process != kPlanner.value() && p.alive && now - p.started_at < kStartTimeout &&
         !robots_[robots_of(ProcessIndex(process)).first.value()].received;
}

void Supervisor::start(ProcessIndex process, SteadyTime now, std::vector<Action>& actions) {
  Process& p = processes_[process.value()];
  p.alive = p.started = true;
  p.started_at = now;
  p.restarts.on_start(now);
  p.silence.on_start(now);
  p.is_killed = false;
  actions.emplace_back(StartProcess{process});
}

// First the restarts that are due, then new processes: at most starts_per_s on average, and at most
// starting_max that are not received yet, restarted ones included. The planner, with index 0, is
// the first.
void Supervisor::start_due(SteadyTime now, std::vector<Action>& actions) {
  std::uint32_t starting = 0;
  for (std::uint32_t i = 0; i < processes(); ++i) starting += is_starting(i, now) ? 1 : 0;
  for (std::uint32_t i = 0; i < processes(); ++i) {
    Process& p = processes_[i];
    if (!p.respawn_due || now < p.respawn_at) continue;
    if (i != kPlanner.value() && starting++ >= options_.launcher.starting_max) continue;
    p.respawn_due = false;
    start(ProcessIndex(i), now, actions);
    actions.emplace_back(LogEvent{
        .code = "respawn",
        .text = i == 0 ? "planner restarted" : fmt::format("agent process {} restarted", i)});
  }
  const double due = 1.0 + to_seconds(now - begun_) * options_.launcher.starts_per_s;
  while (next_start_ < local_processes() && static_cast<double>(next_start_) < due &&
         starting++ < options_.launcher.starting_max) {
    start(ProcessIndex(next_start_++), now, actions);
    last_start_ = now;
  }
}

}  // namespace swarm::launcher
