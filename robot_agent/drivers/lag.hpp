// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "swarm_core/mission/mission.hpp"

namespace swarm::agent {

/// How long a body may take to be at a velocity it is told [s]: what the safety filter allows for.
/// From full speed to rest, v_max/a_max; a unicycle turns by a quarter first. Zero for a single
/// integrator.
inline double lag_s(const BodySpec& body) {
  const double stopping_s = body.speed_max_mps / body.acceleration_max_mps2;
  if (body.model == "double_integrator") return stopping_s;
  if (body.model == "unicycle")
    return stopping_s + 0.5 * std::numbers::pi / body.turn_rate_max_radps;
  return 0.0;
}

}  // namespace swarm::agent
