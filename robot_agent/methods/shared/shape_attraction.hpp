// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "robot_agent/methods/shared/potential.hpp"
#include "swarmflow/core/shape_field.hpp"

namespace swarm::agent {

/// Attraction to the shape that is to be filled [intermittent diffusion, eq. 6]: F(x) = dist(x, S)²
inline Potential shape_attraction(const Vec2& position_m, const ShapeField& shape) {
  const ShapeField::Value f = shape.at(position_m);
  return {f.energy_m2, f.gradient_m, ShapeField::kCurvature};
}

}  // namespace swarm::agent
