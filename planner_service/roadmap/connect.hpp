// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "planner_service/roadmap/edge_check.hpp"
#include "planner_service/roadmap/neighbours.hpp"
#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/planning/roadmap.hpp"

namespace swarm::planner {

/// Edges of the roadmap are proven to keep CVaR ≤ δ + this. Coarse, because thousands are built and
/// a dozen used: those are proven again to kPlanTolerance_m. Proving all of them costs ten times as
/// much.
inline constexpr double kBuildTolerance_m = 0.1;

/// A plan guarantees CVaR ≤ δ + this on every leg.
inline constexpr double kPlanTolerance_m = 1e-3;

/// The roadmap of these edges, each given once; a node's arcs are in the order of the edges, their
/// length is NeighbourPair::distance_m.
Roadmap assemble(std::vector<Gaussian> nodes, std::span<const NeighbourPair> edges);

/// ROADMAPCONSTRUCTION without the sampling: joins all nodes within W₂ ≤ radius whose geodesic is
/// free; `terminals` as in find_neighbours().
Roadmap connect(std::vector<Gaussian> nodes, double radius_m, EdgeChecker& checker,
                std::size_t terminals = 0);

}  // namespace swarm::planner
