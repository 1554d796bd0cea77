// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "robot_agent/neighbours/neighbour_table.hpp"
#include "swarmflow/robot/planned_density.hpp"

namespace swarm::agent {

/// The strength and the kernel.
struct DensityAttractionOptions {
  double push_mps = 0.0;  ///< p; 0 = off
  double kernel_m = 2.0;  ///< h

  /// Standard deviation of the kernel per axis [m]: h²/8 is its second moment.
  double kernel_sigma_m() const { return kernel_m / 2.8284271247461903; }
};

/// The part of U_att that compares the swarm with the mixture [SwarmPRM, eq. 14; ROVER's ref. 35]:
///
///   U(x) = p h (ρ̂ − ρ*) / (ρ̂ + ρ*)         [m²/s], in [−p h, p h]
///   ρ̂(x) = Σⱼ K(‖x − xⱼ‖)      K(d) = 3/(πh²) (1 − d²/h²)² for d < h: a kernel estimate from the
///                               neighbours received, without a root or an exponential
///   ρ*(x)                       the whole mixture at the plan's time, smoothed by a Gaussian as
///   wide
///
/// −∂U/∂x leads from where the swarm is denser than planned to where it is less dense.
double density_potential(const Vec2& position_m, const PlannedDensity& planned,
                         std::span<const Neighbour> neighbours,
                         const DensityAttractionOptions& options);

/// −∂U/∂x [m/s], no faster than p. O(neighbours + parts of the mixture).
Vec2 density_attraction(const Vec2& position_m, const PlannedDensity& planned,
                        std::span<const Neighbour> neighbours,
                        const DensityAttractionOptions& options);

}  // namespace swarm::agent
