// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace swarm::planner {

/// An arc of a flow network; without a capacity its flow is unlimited.
struct FlowArc {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  double cost = 0.0;
  double capacity = std::numeric_limits<double>::infinity();
};

/// Solves the min-cost flow problem
///
///   min Σ cₐ xₐ   s.t.  out(v) − in(v) = bᵥ,  0 ≤ xₐ ≤ uₐ
///
/// by network simplex in whole numbers: masses in units of 2⁻⁵⁰ of the whole supply, costs in units
/// of 2⁻⁶⁰ (nodes + 2) of the largest, but no finer than 2⁻⁵². So its objective is within
/// (arcs on a path) · 2⁻⁶⁰ (nodes + 2) of the largest cost times the mass of the optimum: 1e-12 for
/// a thousand nodes. Flows below kNegligibleFlow of the supply, which only rounding makes, count as
/// 0.
///
/// Returns x, a basic solution, arc by arc; nothing when the supplies do not fit through. \pre the
/// supplies sum to 0 within rounding, some are positive; costs are finite and at least 0,
/// capacities at least 0.
std::optional<std::vector<double>> min_cost_flow(std::span<const double> supplies,
                                                 std::span<const FlowArc> arcs);

inline constexpr double kNegligibleFlow = 1e-12;

}  // namespace swarm::planner
