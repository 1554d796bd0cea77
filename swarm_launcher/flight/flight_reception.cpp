// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What a flight receives over the bus and the stop channel.
#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "swarm_core/app/file_watch.hpp"
#include "swarm_launcher/flight/flight_loop.hpp"
#include "swarm_link/event_names.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kReportRefusalsEvery = std::chrono::seconds(1);
constexpr Duration kOverruleEvery = std::chrono::seconds(1);

}  // namespace

// Republishes statuses and events for monitors, which do not discover the agents.
void FlightLoop::read_bus(const FlightTime& now) {
  ports_.bus.participant->receive();
  ports_.bus.inbox.receive(now.utc);
  for (const link::StatusMessage& status : ports_.bus.inbox.statuses()) {
    if (ports_.observer != nullptr) ports_.observer->on_status(status);
    ports_.bus.status_relay->write(status);
    on_status(status, now);
  }
  for (const link::HeartbeatMessage& beat : ports_.bus.inbox.heartbeats()) {
    supervisor_.on_heartbeat(beat.epoch);
    if (ports_.observer != nullptr) ports_.observer->on_heartbeat(now.steady);
  }
  read_events(now);
  read_stops(now.steady);
}

// A robot whose id is used twice is displayed as well, once: of other events the log is enough.
void FlightLoop::read_events(const FlightTime& now) {
  const auto events = ports_.bus.inbox.events();
  const auto senders = ports_.bus.inbox.event_senders();
  for (std::size_t i = 0; i < events.size(); ++i) {
    // What a process lost is part of the verdict; the gate lets robots and planner alone report it.
    const bool is_loss = events[i].code == shell::kRecordsLost;
    if (!throttle_.admit(senders[i], now.steady) && !is_loss) continue;
    ports_.log.forward(events[i]);
    if (events[i].code == link::kCellsMissing && events[i].source < options_.mission.robots.count) {
      supervisor_.on_hindered(RobotId(events[i].source), events[i].text);
    }
    if (events[i].code != link::kDuplicateId || !duplicates_.insert(events[i].source).second) {
      continue;
    }
    ports_.display.print(fmt::format(
        "{}: its process receives states under an id of its own that another process sent",
        link::source_name(events[i].source)));
  }
  if (const auto dropped = throttle_.report(now.steady)) {
    ports_.log.log(now.utc, {.warning = true, .code = "events-dropped", .text = *dropped});
  }
}

// As agents and planner do, once a second, so that a flood makes few events.
void FlightLoop::report_refusals(const FlightTime& now) {
  if (now.steady - refusals_reported_at_ < kReportRefusalsEvery) return;
  refusals_reported_at_ = now.steady;
  link::report_new(ports_.bus.inbox.refused(), reported_refusals_,
                   [&](link::RefusalReason reason, std::uint32_t times) {
                     ports_.log.note(now.utc, link::Severity::kWarning, "refused",
                                     fmt::format("{} message(s): {}", times, to_string(reason)));
                   });
}

// At most once a second, so that a flood of forged commands or scenes makes few of ours. A scene
// that sets the risk level in force again has a new version and is otherwise the same.
void FlightLoop::overrule(const FlightTime& now) {
  const auto command = foreign_.command_after(last_command_id_);
  const auto scene = foreign_.scene_after(ports_.scene.scene().version);
  if ((!command && !scene) || now.steady - overruled_at_ < kOverruleEvery) return;
  overruled_at_ = now.steady;
  if (command) {
    last_command_id_ = *command;
    ports_.log.note(now.utc, link::Severity::kWarning, "command-foreign",
                    "robots follow a command that this launcher did not send; it sends its own "
                    "again");
    const MissionPhase phase = supervisor_.phase();
    if (phase == MissionPhase::kRunning || phase == MissionPhase::kPaused) {
      send(CommandKind::kStart, now.utc);
      send(phase == MissionPhase::kRunning ? CommandKind::kResume : CommandKind::kPause, now.utc);
    }
  }
  if (scene) {
    ports_.log.note(now.utc, link::Severity::kWarning, "scene-foreign",
                    "the planner follows a scene that this launcher did not publish; it publishes "
                    "its own again");
    ports_.scene.overrule(*scene, options_.mission.planner.risk_alpha, now.utc);
  }
}

// A command sends its stop to the robots, too, past a launcher that may have been suspended: what
// the robots obey holds for the run.
void FlightLoop::read_stops(SteadyTime now) {
  if (ports_.stops == nullptr || !ports_.stops->take()) return;
  if (supervisor_.phase() == MissionPhase::kStopped) return;
  supervisor_.on_command(CommandKind::kStop, now);
  if (ports_.hosts != nullptr) ports_.hosts->on_user_command(CommandKind::kStop);
}

// Positions are kept for robots that fall, and each robot's report goes to the supervisor.
void FlightLoop::on_status(const link::StatusMessage& status, const FlightTime& now) {
  const UtcTime stamp(Duration(status.stamp_utc_ns));
  foreign_.on_status(status, static_cast<std::uint64_t>(
                                 (now.utc + 2 * clock_skew_refuse_).time_since_epoch().count()));
  for (const link::RobotStatusMessage& robot : status.robots) {
    const RobotId id(robot.robot_id);
    view_.take(robot);
    const Obedience obedience{robot.mode, status.command_id, stamp};
    confirmations_.on_status(id, obedience, now.utc);
    // By the earlier clock: a stamp ahead of ours would make the robot's circle too small.
    const UtcTime measured = std::min(stamp, now.utc);
    const Vec2 position_m(robot.x_m, robot.y_m);
    fallen_.on_status(id, {.at = measured, .position_m = position_m, .at_rest = robot.settled});
    if (robot.ticks > 0) {  // before it has no position
      late_.on_status(id, position_m, now.steady - (now.utc - measured), now.steady);
    }
    if (ports_.hosts != nullptr) ports_.hosts->on_status(id, now.steady);
    supervisor_.on_status(
        id, {.has_plan = status.plan_version > 0,
             .receives_neighbours = view_.receives_neighbours(robot.robot_id),
             .mode = robot.mode,
             .settled = robot.settled,
             .scene_version = status.plan_scene_version,
             // On the launcher's steady clock, which the supervisor uses.
             .sent_at = now.steady - (now.utc - stamp),
             .confirms_stop = stop_ && confirms(obedience, *stop_, now.utc, stamp_tolerance_)});
  }
}

}  // namespace swarm::launcher
