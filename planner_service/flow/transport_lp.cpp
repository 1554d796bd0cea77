// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/transport_lp.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "planner_service/flow/min_cost_flow.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// Every component needs a route. One of negligible mass is raised to this, so that rounding does
// not remove its shipment.
constexpr double kLeastMass = 1e-9;

// Raises masses below the least one; the largest component gives what they gain, so that the sum
// stays.
std::vector<double> lifted(std::span<const double> masses) {
  std::vector<double> lifted(masses.begin(), masses.end());
  double lent = 0.0;
  for (double& mass : lifted) {
    SWARM_ASSERT(mass > 0.0);
    if (mass >= kLeastMass) continue;
    lent += kLeastMass - mass;
    mass = kLeastMass;
  }
  *std::max_element(lifted.begin(), lifted.end()) -= lent;
  return lifted;
}

}  // namespace

// The transport problem (13) as min-cost flow on the bipartite network of starts and goals, without
// arcs for pairs that no route joins.
std::optional<std::vector<Shipment>> solve_transport(std::span<const double> supplies,
                                                     std::span<const double> demands,
                                                     std::span<const double> costs_m) {
  SWARM_ASSERT(costs_m.size() == supplies.size() * demands.size());
  std::vector<double> balance = lifted(supplies);
  for (const double demand : lifted(demands)) balance.push_back(-demand);
  std::vector<Shipment> candidates;
  std::vector<FlowArc> arcs;
  for (std::size_t i = 0; i < supplies.size(); ++i) {
    for (std::size_t j = 0; j < demands.size(); ++j) {
      const double cost_m = costs_m[i * demands.size() + j];
      if (!std::isfinite(cost_m)) continue;
      arcs.push_back({.from = static_cast<std::uint32_t>(i),
                      .to = static_cast<std::uint32_t>(supplies.size() + j),
                      .cost = cost_m});
      candidates.push_back({i, j, 0.0});
    }
  }
  const auto flow = min_cost_flow(balance, arcs);
  if (!flow) return std::nullopt;
  std::vector<Shipment> shipments;
  for (std::size_t a = 0; a < candidates.size(); ++a) {
    if ((*flow)[a] == 0.0) continue;
    candidates[a].mass = (*flow)[a];
    shipments.push_back(candidates[a]);
  }
  return shipments;
}

std::vector<double> weights_of(std::span<const WeightedGaussian> components) {
  std::vector<double> weights;
  weights.reserve(components.size());
  for (const WeightedGaussian& component : components) weights.push_back(component.weight);
  return weights;
}

std::string unjoined_pairs(std::span<const double> costs_m, std::size_t goals) {
  std::string pairs;
  for (std::size_t i = 0; i < costs_m.size(); ++i) {
    if (std::isfinite(costs_m[i])) continue;
    pairs += fmt::format("{}{} -> {}", pairs.empty() ? "" : ", ", i / goals, i % goals);
  }
  return pairs;
}

}  // namespace swarm::planner
