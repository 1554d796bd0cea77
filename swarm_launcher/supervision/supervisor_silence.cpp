// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Processes that publish nothing although they run: they are named, and later ended.
#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {
namespace {

// The launcher steps every 20 ms. After a longer gap it was suspended or starved itself, and what
// its processes sent meanwhile may still be on its path.
constexpr Duration kOwnGap = std::chrono::seconds(1);
// A restarted planner plans before it publishes, an agent joins the bus. They have at least this
// long, and as long as the mission gives all processes for their start.
constexpr double kFirstBeat_s = 30.0;
// A process that the launcher cannot end any more, or not from here: after this time without it the
// mission goes on without its robots.
constexpr Duration kGivenUp = std::chrono::seconds(60);

}  // namespace

// A heartbeat that the planner's predecessor sent before its end may arrive after the restart.
void Supervisor::on_heartbeat(std::uint64_t epoch) {
  if (epoch == ended_epoch_) return;
  planner_epoch_ = epoch;
  processes_[kPlanner.value()].silence.on_received();
}

// A process that hangs or is cut off reports nothing, and does not end either, so an event names
// it.
void Supervisor::watch_silence(SteadyTime now, std::vector<Action>& actions) {
  const bool was_suspended = stepped_at_ && now - *stepped_at_ > kOwnGap;
  stepped_at_ = now;
  if (was_suspended) suspended_at_ = now;
  for (std::uint32_t i = 0; i < processes(); ++i) {
    Process& p = processes_[i];
    if (!p.alive) continue;  // its end has been reported
    if (was_suspended) p.silence.restart(now);
    const SilenceWatch::Change change = p.silence.step(now, limits_of(i));
    give_up(ProcessIndex(i), now, actions);
    if (change == SilenceWatch::Change::kNone) continue;
    const bool is_silent = change == SilenceWatch::Change::kSilent;
    actions.emplace_back(
        LogEvent{.warning = is_silent,
                 .code = fmt::format("{}-{}", i == kPlanner.value() ? "planner" : "agent",
                                     is_silent ? "silent" : "back"),
                 .text = name_of(ProcessIndex(i)) +
                         (is_silent ? fmt::format(" has sent no {} for {:.0f} s", sign_of_life(i),
                                                  to_seconds(limits_of(i).reported))
                                    : fmt::format(" sends its {} again", sign_of_life(i)))});
    if (is_silent) assume_still(ProcessIndex(i), now);
  }
  end_silent(now, actions);
}

// All silences count anew from there.
bool Supervisor::knows_silent(SteadyTime now) const {
  return !suspended_at_ || now - *suspended_at_ > options_.agent_silence.reported;
}

/// A process of another host, which may itself be stopped so that it does not report the end of the
/// process, or one that was killed and does not end, as it waits for a disk. Its robots are absent
/// until they are received again.
void Supervisor::give_up(ProcessIndex process, SteadyTime now, std::vector<Action>& actions) {
  const Process& p = processes_[process.value()];
  if (process == kPlanner || stage_ != Stage::kRunning || !(is_remote(process) || p.is_killed))
    return;
  if (!p.silence.is_silent() || p.silence.silent_for(now) <= kGivenUp) return;
  const auto [first, count] = robots_of(process);
  bool is_new = false;
  for (std::uint32_t i = first.value(); i < first.value() + count; ++i) {
    is_new = !std::exchange(robots_[i].absent, true) || is_new;
  }
  if (!is_new) return;
  actions.emplace_back(LogEvent{.warning = true,
                                .code = "agent-given-up",
                                .text = fmt::format("{} has been silent for {:.0f} s: the mission "
                                                    "goes on without its robots",
                                                    name_of(process), to_seconds(kGivenUp))});
}

// The process may be frozen: its robots are obstacles until they are received again.
void Supervisor::assume_still(ProcessIndex process, SteadyTime now) {
  const auto [first, count] = robots_of(process);
  for (std::uint32_t i = first.value(); i < first.value() + count; ++i) {
    if (!robots_[i].silent_since) on_silent(RobotId(i), now);
  }
}

/// Whether the launcher receives another host.
bool Supervisor::receives_other_hosts(SteadyTime now) const {
  const auto remote = std::span(processes_).subspan(local_processes());
  return std::ranges::any_of(remote, [&](const Process& p) {
    return p.alive && !p.silence.is_silent() && p.silence.unreceived_for(now) == Duration::zero();
  });
}

// SIGKILL, because a process that hangs does not act on other signals. Its end is then handled as
// any other. If more than half are silent at once, the launcher cannot receive or the machine is
// overloaded: to end processes would not help. The planner may be the only process here, or the
// last one: then other hosts show that the launcher does receive.
void Supervisor::end_silent(SteadyTime now, std::vector<Action>& actions) {
  const auto local = std::span(processes_).first(local_processes());
  const auto alive = std::ranges::count_if(local, [](const Process& p) { return p.alive; });
  const auto silent = std::ranges::count_if(
      local, [](const Process& p) { return p.alive && p.silence.is_silent(); });
  const bool most_are_silent = 2 * silent > alive;
  for (std::uint32_t i = 0; i < local.size(); ++i) {
    Process& p = processes_[i];
    if (!p.alive || p.is_killed) continue;
    const bool is_planner = i == kPlanner.value();
    if (most_are_silent && !(is_planner && receives_other_hosts(now))) continue;
    const bool is_restarted = is_planner || p.restarts.deaths_in_a_row() > 0;
    const bool hangs_at_restart = is_restarted && stage_ == Stage::kRunning &&
                                  p.silence.unreceived_for(now) > first_beat_timeout();
    if (!p.silence.is_overdue(now, limits_of(i)) && !hangs_at_restart) continue;
    p.is_killed = true;
    actions.emplace_back(SignalProcess{ProcessIndex(i), EndSignal::kKill});
    actions.emplace_back(LogEvent{
        .warning = true,
        .code = "silent-killed",
        .text =
            fmt::format("{} has sent no {} for {:.0f} s: it is killed", name_of(ProcessIndex(i)),
                        sign_of_life(i),
                        to_seconds(hangs_at_restart ? first_beat_timeout() : limits_of(i).ended))});
  }
}

Duration Supervisor::first_beat_timeout() const {
  return from_seconds(std::max(kFirstBeat_s, options_.launcher.quorum_timeout_s));
}

std::string_view Supervisor::sign_of_life(std::uint32_t process) {
  return process == kPlanner.value() ? "heartbeat" : "status";
}

std::string Supervisor::name_of(ProcessIndex process) const {
  if (process == kPlanner) return "the planner";
  const auto [first, count] = robots_of(process);
  return fmt::format("agent process {} (robots {} to {})", process.value(), first.value(),
                     first.value() + count - 1);
}

// A robot that is absent has not reported since its process was started, so it has not made a
// control step either: the mission goes on without it, as without a dead one.
void Supervisor::leave_out_absent(SteadyTime now) {
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    Robot& r = robots_[i];
    const Process& p = process_of(RobotId(i));
    r.lost = r.lost || !p.started;
    if (r.received || r.lost) continue;
    r.absent = true;
    if (p.alive) on_silent(RobotId(i), now);
  }
}

}  // namespace swarm::launcher
