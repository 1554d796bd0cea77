// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/collocation.hpp"

#include <cmath>

#include <fmt/format.h>

namespace swarm::planner {

// The bounds of the count are checked in double: a tiny spacing would overflow an integer.
Result<std::vector<Gaussian>> collocation_set(const Box& bounds_m,
                                              const CollocationOptions& options) {
  const bool valid = options.spacing_m > 0.0 && options.sigma_m >= Gaussian::kMinSigma_m &&
                     options.sigma_m <= Gaussian::kMaxSigma_m;
  if (!valid) {
    return fail(ErrorCode::kBadInput,
                fmt::format("collocation set: spacing {} m must be > 0 and sigma {} m in [{}, {}]",
                            options.spacing_m, options.sigma_m, Gaussian::kMinSigma_m,
                            Gaussian::kMaxSigma_m));
  }
  const Vec2 size_m = bounds_m.max_m - bounds_m.min_m;
  // Whole cells of the grid; the first mean is half a spacing from the border. The summand absorbs
  // the rounding of a quotient that is a whole number.
  const double columns = std::floor(size_m.x() / options.spacing_m + 1e-9);
  const double rows = std::floor(size_m.y() / options.spacing_m + 1e-9);
  if (!(columns * rows >= 1.0 && columns * rows <= static_cast<double>(kMaxCollocation))) {
    return fail(ErrorCode::kBadInput,
                fmt::format("collocation set: a spacing of {} m puts {} x {} Gaussians on the "
                            "area, 1 to {} are allowed; change the spacing",
                            options.spacing_m, columns, rows, kMaxCollocation));
  }
  std::vector<Gaussian> set;
  set.reserve(static_cast<std::size_t>(columns * rows));
  for (double row = 0.0; row < rows; row += 1.0) {
    for (double column = 0.0; column < columns; column += 1.0) {
      const Vec2 mean_m = bounds_m.min_m + options.spacing_m * Vec2(column + 0.5, row + 0.5);
      set.push_back(Gaussian::from_parameters(mean_m, options.sigma_m, options.sigma_m, 0.0));
    }
  }
  return set;
}

}  // namespace swarm::planner
