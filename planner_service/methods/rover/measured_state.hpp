// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "planner_service/methods/rover/risk_graph.hpp"
#include "swarmflow/core/mixture.hpp"

namespace swarm::planner {

/// Weights ω of the most likely mixture of the given Gaussians, from positions of robots: EM with
/// fixed components,
///
///   ωⱼ ← 1/N Σᵢ ωⱼ gⱼ(xᵢ) / Σₗ ωₗ gₗ(xᵢ),
///
/// from equal weights until no weight changes by 1e-9, at most 2000 rounds of O(robots ·
/// components). The likelihood is concave in ω, so this is its maximum. Sums to 1. \pre both not
/// empty
std::vector<double> estimate_weights(std::span<const Gaussian> components,
                                     std::span<const Vec2> positions_m);

/// The swarm's mixture as the FTMPC starts from it: components of the graph (goal components and C)
/// near the robots and in sight of them, with estimated weights. A component that would hold less
/// than a quarter of a robot is left out. \pre positions not empty
Mixture measured_mixture(const RiskGraph& graph, std::span<const Vec2> positions_m);

}  // namespace swarm::planner
