// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "swarmflow/core/mixture.hpp"

namespace swarm::planner {

/// Mass λᵢⱼ on the route from start component i to goal component j.
struct Shipment {
  std::size_t from = 0;
  std::size_t to = 0;
  double mass = 0.0;
};

/// Solves the transport problem                                                  [SwarmPRM, eq. 13]
///
///   min Σᵢⱼ λᵢⱼ Lᵢⱼ   s.t.  Σⱼ λᵢⱼ = ωᵢ,  Σᵢ λᵢⱼ = ω'ⱼ,  λᵢⱼ ≥ 0
///
/// to the exactness of min_cost_flow(), 1e-12 of the largest cost, but every component counts at
/// least 1e-9; a basic solution, so at most supplies + demands − 1 shipments, ordered by (from,
/// to). `costs_m` is row-major [supplies × demands], +∞ where no route exists. Nothing when no
/// transport avoids those. \pre supplies and demands are positive and each sum to 1.
std::optional<std::vector<Shipment>> solve_transport(std::span<const double> supplies,
                                                     std::span<const double> demands,
                                                     std::span<const double> costs_m);

/// The weights of components, in their order: supplies or demands of a transport problem.
std::vector<double> weights_of(std::span<const WeightedGaussian> components);

/// `0 -> 1, 2 -> 1`: the pairs of start and goal components that no route joins, for an error.
/// `costs_m` as in solve_transport().
std::string unjoined_pairs(std::span<const double> costs_m, std::size_t goals);

}  // namespace swarm::planner
