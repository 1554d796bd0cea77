// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "robot_agent/neighbours/neighbour_table.hpp"

namespace swarm::agent {

/// Range and strength of the push.
struct NeighbourRepulsionOptions {
  double radius_m = 0.2;
  double gap_m = 0.6;     ///< d0
  double push_mps = 0.6;  ///< at contact
};

/// −∂U_rep/∂x of the neighbours [m/s] [SwarmPRM, eq. 14].
///
///   U_rep = Σ_j ½ p d0 (1 − gap_j/d0)² for gap_j < d0      so each pushes with p (1 − gap_j/d0)
Vec2 neighbour_repulsion(const Vec2& position_m, std::span<const Neighbour> neighbours,
                         const NeighbourRepulsionOptions& options);

}  // namespace swarm::agent
