// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "swarmflow/core/mixture.hpp"

/// Peak densities of a swarm and of its plan, both as means over discs of the same radius: a disc
/// of 2 m averages over many robots instead of resolving single ones.
namespace swarm::monitor {

inline constexpr double kDiscRadius_m = 2.0;

/// The most points that any disc of this radius holds, wherever its centre lies: exact. A disc that
/// holds the most can be moved until a point lies on its rim, so the discs through each point are
/// swept. O(n k log k) for k points within 2 radii.
std::size_t most_in_a_disc(std::span<const Vec2> points, double radius_m);

/// The same as a density [1/m²].
double peak_density_per_m2(std::span<const Vec2> points);

/// The largest mean density of n·χ over a disc of kDiscRadius_m [1/m²]: density at the points of a
/// grid of at most 1 m (of the smallest σ, where that is less, down to 0.25 m), weighted by the
/// part of each cell that lies in the disc, for discs around all points of the grid. Discs between
/// them and the grid itself miss less than 5 % for σ ≥ 1 m (tested). Expected robots, so without
/// the scatter of a count. O(components · cells within 4σ).
double planned_peak_density_per_m2(const Mixture& mixture, std::size_t robots);

}  // namespace swarm::monitor
