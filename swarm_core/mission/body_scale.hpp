// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "swarmflow/mission/sections/robots.hpp"

namespace swarm {

/// Lengths and speeds that are constants of the program, such as "at rest below 5 cm/s", hold for
/// the robots of the default mission: 0.2 m and 1.5 m/s. For others they are multiplied by this
/// factor, so that a mission behaves alike when it is enlarged or reduced as a whole:
///
///   the one of r / 0.2 m and v / 1.5 m/s that is nearer to 1; 1 if they lie on both sides of it
///
/// Some constants are about the body and some about how far it drives in a time, most about both;
/// a small body that is fast needs the distances of a fast one, and a large slow one those of a
/// large one.
inline double length_scale(const BodySpec& body) {
  const BodySpec usual;
  const double by_radius = body.radius_m / usual.radius_m;
  const double by_speed = body.speed_max_mps / usual.speed_max_mps;
  return std::clamp(1.0, std::min(by_radius, by_speed), std::max(by_radius, by_speed));
}

/// The same for what concerns all robots, such as a plan: of the largest ones.
inline double length_scale(const RobotsSpec& robots) {
  double scale = 0.0;
  std::uint64_t grouped = 0;
  for (const RobotGroupSpec& group : robots.groups) {
    scale = std::max(scale, length_scale(static_cast<const BodySpec&>(group)));
    grouped += group.count;
  }
  if (grouped < robots.count || scale == 0.0) {
    scale = std::max(scale, length_scale(static_cast<const BodySpec&>(robots)));
  }
  return scale;
}

}  // namespace swarm
