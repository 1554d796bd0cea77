// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/mission/body_limits.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "swarm_core/mission/body_scale.hpp"

namespace swarm {
namespace {

// A unicycle (λ = 1.02 s, 1.5 m/s) follows plans of 0.8 robots/m² and not of 1.5: d = 1.03 m.
constexpr double kRoomPerLag = 0.25;
// Shares measured in runs; SwarmLimits documents what each of them bounds.
constexpr double kCapShare = 0.75;
constexpr double kPlanSpeedShare = 0.9;
constexpr double kPlanSpeedLostPerLag_hz = 0.4;
// A longer lag costs no more speed: the plan must keep moving.
constexpr double kLagMost_s = 0.5;
constexpr double kRobotSpeedShare = 0.93;

// Hexagonal packing of discs at centre distance d: one disc for each area of √3/2 d².
double packing_per_m2(double distance_m) {
  return 2.0 / (std::numbers::sqrt3 * distance_m * distance_m);
}

}  // namespace

double declared_lag_s(const BodySpec& body, const LagSpec& lag) {
  double lag_s = lag.fixed_s;
  if (lag.accelerates) lag_s += body.speed_max_mps / body.acceleration_max_mps2;
  if (lag.turns) lag_s += 0.5 * std::numbers::pi / body.turn_rate_max_radps;
  return lag_s;
}

double body_lag_s(const BodySpec& body) { return body.lag_s.value_or(0.0); }

SwarmLimits swarm_limits(const RobotsSpec& robots, const SafetySpec& safety,
                         const ControlSpec& control) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  SwarmLimits limits{kNone, kNone, kNone, kNone, length_scale(robots)};
  // Every limit is the minimum over the bodies, as one plan serves the whole swarm.
  const auto restrict_to = [&](const BodySpec& body) {
    const double lag_s = body_lag_s(body);
    const double speed_mps = std::min(body.speed_max_mps, control.cruise_mps);
    const double distance_m =
        2.0 * body.radius_m + safety.neighbour_margin_m + kRoomPerLag * body.speed_max_mps * lag_s;
    const double share = kPlanSpeedShare - kPlanSpeedLostPerLag_hz * std::min(lag_s, kLagMost_s);
    limits.packing_per_m2 = std::min(limits.packing_per_m2, packing_per_m2(distance_m));
    limits.plan_speed_mps = std::min(limits.plan_speed_mps, share * speed_mps);
    limits.robot_speed_mps = std::min(limits.robot_speed_mps, kRobotSpeedShare * speed_mps);
  };
  std::uint64_t grouped = 0;
  for (const RobotGroupSpec& group : robots.groups) {
    restrict_to(group);
    grouped += group.count;
  }
  // The body given for all robots counts only if some robots are in no group.
  if (grouped < robots.count) restrict_to(robots);
  limits.cap_per_m2 = kCapShare * limits.packing_per_m2;
  return limits;
}

}  // namespace swarm
