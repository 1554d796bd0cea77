// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// The velocities u with n·u ≤ b; n is a unit vector.
struct HalfPlane {
  Vec2 normal = Vec2::Zero();
  double bound_mps = 0.0;
};

/// The velocity nearest to `desired_velocity` within all half-planes and the disc ‖u‖ ≤ speed_max;
/// nothing when they have no common point. Exact (Seidel's incremental method on a strictly convex
/// objective: a violated constraint is active at the new optimum). O(n) expected, O(n²) worst; no
/// allocation.
std::optional<Vec2> nearest_velocity(const Vec2& desired_mps,
                                     std::span<const HalfPlane> constraints, double speed_max_mps);

}  // namespace swarm::agent
