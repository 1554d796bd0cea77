// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// The collocation set C of ROVER, sec. III-A: its components on a grid, all of one shape.
struct CollocationOptions {
  double spacing_m = 10.0;
  double sigma_m = 7.0710678118654755;  ///< Σ_c = σ² I; the paper's 50 m²
};

/// With more components the FTMPC no longer plans a step in about a control period.
inline constexpr std::size_t kMaxCollocation = 4096;

/// N(μ, σ²I) with means half a spacing and whole spacings from the lower left corner of the bounds,
/// row by row from below. 320 on the paper's area. kBadInput when spacing or σ is not positive or
/// the grid has no point or more than kMaxCollocation.
Result<std::vector<Gaussian>> collocation_set(const Box& bounds_m,
                                              const CollocationOptions& options);

}  // namespace swarm::planner
