// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "robot_agent/methods/apf/cotangent_repulsion.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/shape_field.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::agent {

/// Noise, duration and clearance.
struct DiffusionOptions {
  double noise_mps05 = 3.0;  ///< largest σ [m/√s]; each run and axis draws its own from U(0, 1)
  double time_s = 10.0;      ///< largest duration, drawn as well
  double clearance_m = 0.1;  ///< kept to obstacles and the border
};

/// The potential F + G that a robot diffuses in.
struct DiffusionPotential {
  const ShapeField* shape = nullptr;  ///< null: no attraction
  std::span<const Neighbour> neighbours;
  CotangentOptions repulsion;
};

/// Where a robot that is stuck at `from_m` would be after diffusing for a while [intermittent
/// diffusion, eq. 11, 12 and 16]: computed only, no robot drives this path.
///
///   dX = −∇(F + G) dt + σ dW,     then σ = 0 for the last fifth of the steps
///
/// by Euler–Maruyama, mirrored at the border of the world; a step that would hit an obstacle is not
/// made, which is what reflection does on average. Neighbours stay at their present estimates. If
/// `in_sight`, the result is the last position of the path that can be reached straight. 128 steps,
/// about 20 µs; does not allocate.
Vec2 virtual_diffusion(const Vec2& from_m, const DiffusionPotential& potential, const World& world,
                       bool in_sight, const DiffusionOptions& options, Rng& rng);

}  // namespace swarm::agent
