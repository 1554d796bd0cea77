// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "swarm_core/mission/body_scale.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::agent {

/// What the safety filter keeps off obstacles [m]: the mission's margin, and twice the noise of a
/// measured position and a step.
inline double obstacle_margin_m(const Mission& mission, const BodySpec& body) {
  return mission.safety.obstacle_margin_m +
         2.0 * std::hypot(body.position_noise_m, body.motion_noise_m);
}

/// Gap above which a robot has room [m]. In a dense region gaps shrink to the filter's margin, so
/// fields that push robots apart begin well above it.
inline double room_gap_m(const Mission& mission, const BodySpec& body) {
  return mission.safety.neighbour_margin_m + length_scale(body) * 0.5;
}

}  // namespace swarm::agent
