// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/fallen_body.hpp"

#include <algorithm>

namespace swarm::launcher {
namespace {

/// Two steps this many periods apart or less are taken as consecutive.
constexpr double kPeriodsOfATick = 3.0;

/// Distance [m] that a robot covers from its present speed: first under a command, then braking.
double travel_m(const BodySpec& body, double speed_mps, double command_mps, double command_s) {
  const double commanded_m = command_mps * command_s;
  if (body.model == "single_integrator") return commanded_m;
  // It brakes at once, or it moves at most at the larger of the two speeds and brakes afterwards.
  const double fastest_mps = std::max(speed_mps, command_mps);
  return commanded_m + fastest_mps * fastest_mps / (2.0 * body.acceleration_max_mps2);
}

/// How long a robot may have driven on, and may still do so, in any direction. [s]
double moving_s(const LastKnown& known, double age_s, const Mission& mission) {
  const double status_s = 1.0 / mission.link.status_hz;
  const double holds_s = mission.timing.planner_silence_s;
  return known.command_mps ? status_s + holds_s : std::min(age_s, status_s + holds_s);
}

}  // namespace

Duration longest_between_steps(const Mission& mission) {
  return from_seconds(kPeriodsOfATick / mission.control.rate_hz);
}

// The speed is the mean over the last period, if the record before is recent enough.
std::optional<LastKnown> last_known(std::span<const robot_log::Step> steps,
                                    const Mission& mission) {
  if (steps.empty()) return std::nullopt;
  const robot_log::Step& last = steps.back();
  LastKnown known{
      .at = last.stamp, .position_m = last.position_m, .command_mps = last.velocity_mps};
  if (steps.size() < 2) return known;
  const robot_log::Step& before = steps[steps.size() - 2];
  const double between_s = to_seconds(last.stamp - before.stamp);
  if (between_s > 0.0 && between_s <= to_seconds(longest_between_steps(mission))) {
    known.speed_mps = (last.position_m - before.position_m).norm() / between_s;
  }
  return known;
}

// Three cases after the body at rest: its last command is not known, a body that follows commands
// at once, a body with inertia.
Circle circle_of_fallen(const LastKnown& known, UtcTime now, const Mission& mission,
                        RobotId robot) {
  const BodySpec& body = body_of(mission.robots, robot);
  const double period_s = 1.0 / mission.control.rate_hz;
  const double command_s = to_seconds(robot_log::command_lifetime(from_seconds(period_s)));
  const double age_s = std::max(0.0, to_seconds(now - known.at));
  Circle circle{.center_m = known.position_m, .radius_m = body.radius_m};
  if (known.at_rest) return circle;
  if (!known.command_mps || !known.is_last) {
    const double fastest_mps = body.speed_max_mps;
    circle.radius_m += fastest_mps * moving_s(known, age_s, mission) +
                       travel_m(body, fastest_mps, fastest_mps, command_s);
  } else if (body.model == "single_integrator") {
    circle.center_m += 0.5 * command_s * *known.command_mps;
    circle.radius_m += 0.5 * command_s * known.command_mps->norm();
  } else {  // a body with inertia need not move as commanded
    // The speed is a mean over a period: at its end the robot may have been faster by this.
    const double gained_mps = period_s * body.acceleration_max_mps2;
    const double command_mps = known.command_mps->norm();
    const double speed_mps = known.speed_mps ? *known.speed_mps + gained_mps : body.speed_max_mps;
    const bool is_stopped = known.speed_mps && *known.speed_mps == 0.0 && command_mps == 0.0;
    if (!is_stopped) {
      circle.radius_m +=
          travel_m(body, std::min(speed_mps, body.speed_max_mps), command_mps, command_s);
    }
  }
  return circle;
}

}  // namespace swarm::launcher
