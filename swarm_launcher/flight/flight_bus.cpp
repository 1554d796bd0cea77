// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What a flight publishes and receives on the bus.
#include "swarm_core/base/clock.hpp"
#include "swarm_launcher/flight/flight.hpp"

namespace swarm::launcher {

// The UTC stamp serves as the command's id, so ids increase also after a restart of the launcher.
void Flight::send(CommandKind kind) {
  const std::int64_t stamp = utc_now().time_since_epoch().count();
  run_->bus().commands->write(
      {.kind = kind, .command_id = static_cast<std::uint64_t>(stamp), .stamp_utc_ns = stamp});
}

void Flight::note(link::Severity severity, const std::string& code, const std::string& text) {
  const UtcTime now = utc_now();
  events_.write(now, "launcher", severity, code, text);
  run_->bus().event_relay->write({.severity = severity,
                                  .source = link::kLauncherSource,
                                  .stamp_utc_ns = now.time_since_epoch().count(),
                                  .code = code,
                                  .text = text});
}

void Flight::log(const LogEvent& event) {
  note(event.warning ? link::Severity::kWarning : link::Severity::kInfo, event.code, event.text);
  if (event.warning) progress_.print(event.text);
}

// Republishes statuses and events for monitors, which do not discover the agents. Positions are
// kept for robots that fall, and each robot's report goes to the supervisor.
void Flight::read_bus(SteadyTime now) {
  run_->bus().participant->receive();
  run_->bus().inbox.receive(utc_now());
  for (const link::StatusMessage& status : run_->bus().inbox.statuses()) {
    if (observer_ != nullptr) observer_->on_status(status);
    run_->bus().status_relay->write(status);
    const UtcTime stamp(Duration(status.stamp_utc_ns));
    // The sender's stamp on the launcher's steady clock, which the supervisor uses.
    const SteadyTime sent_at = now - (utc_now() - stamp);
    for (const link::RobotStatusMessage& robot : status.robots) {
      view_.take(robot);
      reported_[robot.robot_id] = {
          .at = stamp, .position_m = {robot.x_m, robot.y_m}, .at_rest = robot.settled};
      if (run_->hosts() != nullptr) run_->hosts()->on_status(RobotId(robot.robot_id), now);
      supervisor_->on_status(RobotId(robot.robot_id),
                             {.has_plan = status.plan_version > 0,
                              .receives_neighbours = view_.receives_neighbours(robot.robot_id),
                              .mode = robot.mode,
                              .settled = robot.settled,
                              .scene_version = status.plan_scene_version,
                              .sent_at = sent_at});
    }
  }
  for (const link::EventMessage& event : run_->bus().inbox.events()) {
    events_.write(event);
    run_->bus().event_relay->write(event);
  }
}

}  // namespace swarm::launcher
