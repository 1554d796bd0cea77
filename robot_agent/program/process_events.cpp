// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/program/process_events.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "swarm_link/event_names.hpp"

namespace swarm::agent {
namespace {

constexpr Duration kStatsEvery = std::chrono::seconds(1);
constexpr Duration kWakingEvery = std::chrono::seconds(10);

constexpr std::string_view code_of(StandReason reason) {
  switch (reason) {
    case StandReason::kNone:
      return "moves-again";
    case StandReason::kCellsMissing:
    case StandReason::kFilesMissing:
      return link::kCellsMissing;
    case StandReason::kWaking:
      return "woke-late";
    case StandReason::kCutOff:
      return "cut-off";
    case StandReason::kIsObstacle:
      return "is-obstacle";
  }
  return "";
}

}  // namespace

/// Planner and faults at every tick, since they change what robots do; counters once a second.
void ProcessEvents::on_tick(SteadyTime now, UtcTime utc_now, Inbox& inbox,
                            const Histogram& state_age) {
  announce_planner(now, utc_now, inbox);
  announce_faults(utc_now);
  announce_duplicate(utc_now, inbox);
  if (now - stats_at_ < kStatsEvery) return;
  stats_at_ = now;
  record_link_stats(utc_now, inbox, state_age);
  announce_refusals(utc_now, inbox);
}

/// Refusals and ages of states belong to the process: the log of its first robot has them.
void ProcessEvents::record_link_stats(UtcTime utc_now, Inbox& inbox, const Histogram& state_age) {
  for (LocalRobot& robot : robots_) {
    robot_log::LinkStats stats{.stamp = utc_now,
                               .states_sent = robot.loop.states_sent(),
                               .states_received = robot.loop.states_received()};
    if (&robot == &robots_.front()) {
      stats.state_age = state_age;
      stats.refused.assign(inbox.refused().all().begin(), inbox.refused().all().end());
    }
    robot.log.append(stats);
  }
}

void ProcessEvents::send(UtcTime utc_now, link::Severity severity, const std::string& code,
                         const std::string& text) {
  writer_.write({.severity = severity,
                 .source = robots_.front().loop.id().value(),
                 .stamp_utc_ns = utc_now.time_since_epoch().count(),
                 .code = code,
                 .text = text});
}

/// On the bus for the operator, and in the first robot's log for the audit, which works without a
/// bus.
void ProcessEvents::announce(UtcTime utc_now, link::Severity severity, const std::string& code,
                             const std::string& text) {
  send(utc_now, severity, code, text);
  robots_.front().log.append(robot_log::Note{.stamp = utc_now, .code = code, .text = text});
}

void ProcessEvents::announce_planner(SteadyTime now, UtcTime utc_now, const Inbox& inbox) {
  const bool alive = inbox.mission().planner_alive(now);
  if (alive == planner_was_alive_) return;
  planner_was_alive_ = alive;
  announce(utc_now, alive ? link::Severity::kInfo : link::Severity::kWarning,
           alive ? "planner-heard" : "planner-silent",
           alive ? "receives the planner" : "planner silent: holds with avoidance on");
}

void ProcessEvents::on_permit(SteadyTime now, UtcTime utc_now, StandReason reason) {
  if (reason == stand_) return;
  stand_ = reason;
  const bool moves = reason == StandReason::kNone;
  const bool was_reported = std::exchange(stand_reported_, false);
  const bool before_first_move = !has_moved_ && (moves || reason == StandReason::kCutOff);
  has_moved_ = has_moved_ || moves;
  if (before_first_move || (moves && !was_reported)) return;
  if (reason == StandReason::kWaking) {
    if (waking_reported_at_ && now - *waking_reported_at_ < kWakingEvery) return;
    waking_reported_at_ = now;
  }
  stand_reported_ = !moves;
  announce(utc_now, moves ? link::Severity::kInfo : link::Severity::kWarning,
           std::string(code_of(reason)), std::string(to_string(reason)));
}

void ProcessEvents::on_launcher(UtcTime utc_now, bool is_lost) {
  if (is_lost == launcher_was_lost_) return;
  launcher_was_lost_ = is_lost;
  announce(
      utc_now, is_lost ? link::Severity::kWarning : link::Severity::kInfo,
      is_lost ? "launcher-silent" : "launcher-back",
      is_lost ? "launcher silent: as launcher.on_launcher_loss demands" : "receives the launcher");
}

void ProcessEvents::on_overrun(UtcTime utc_now, Duration took) {
  const std::uint32_t first = robots_.front().loop.id().value();
  announce(utc_now, link::Severity::kError, "tick-overrun",
           fmt::format("robots {} to {}: a tick took {:.1f} s; their commands ran out, so their "
                       "bodies stopped meanwhile",
                       first, first + robots_.size() - 1, to_seconds(took)));
}

/// A fault of a robot is announced once, and again when it changes or ends.
void ProcessEvents::announce_faults(UtcTime utc_now) {
  faults_.resize(robots_.size());
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const std::string& fault = robots_[i].loop.fault();
    if (fault == faults_[i]) continue;
    faults_[i] = fault;
    const std::uint32_t id = robots_[i].loop.id().value();
    announce(utc_now, fault.empty() ? link::Severity::kInfo : link::Severity::kError, "robot-fault",
             fault.empty() ? fmt::format("robot {}: works again", id)
                           : fmt::format("robot {}: {}", id, fault));
  }
}

/// Announces only what has been added since the last time, at most one event per reason and second.
void ProcessEvents::announce_refusals(UtcTime utc_now, Inbox& inbox) {
  if (const std::uint32_t fresh = inbox.skewed() - skewed_reported_; fresh > 0) {
    skewed_reported_ += fresh;
    announce(utc_now, link::Severity::kWarning, "clock-skew",
             fmt::format("{} state(s) from a clock that differs from ours", fresh));
  }
  for (std::size_t i = 0; i < link::kRefusalReasons; ++i) {
    const auto reason = static_cast<link::RefusalReason>(i);
    const std::uint32_t fresh = inbox.refused()[reason] - reported_[reason];
    if (fresh == 0) continue;
    reported_.count(reason, fresh);
    announce(utc_now, link::Severity::kWarning, "refused",
             fmt::format("{} message(s): {}", fresh, link::to_string(reason)));
  }
}

void ProcessEvents::on_files(UtcTime utc_now, const shell::FileHealth& health) {
  const auto event = files_.step(health);
  if (!event) return;
  announce(utc_now, event->is_warning ? link::Severity::kWarning : link::Severity::kInfo,
           std::string(event->code), event->text);
}

/// One event for all robots of the process.
void ProcessEvents::on_losses(UtcTime utc_now, std::span<const shell::FileLoss> losses) {
  if (losses.empty()) return;
  std::string text = shell::describe(losses.front());
  if (losses.size() > 1) text += fmt::format("; and {} more", losses.size() - 1);
  send(utc_now, link::Severity::kWarning, std::string(shell::kRecordsLost), text);
}

/// Once: which of the two processes is to end is for a person to decide.
void ProcessEvents::announce_duplicate(UtcTime utc_now, const Inbox& inbox) {
  const auto id = inbox.duplicate_id();
  if (!id || duplicate_announced_) return;
  duplicate_announced_ = true;
  announce(utc_now, link::Severity::kError, std::string(link::kDuplicateId),
           fmt::format("robot {}: a state arrived under its id that it did not publish: another "
                       "process uses the id, or forges states",
                       id->value()));
}

}  // namespace swarm::agent
