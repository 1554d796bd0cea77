// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "swarm_core/base/assert.hpp"

namespace swarm::monitor {

/// The smallest value that at least a share q of all values do not exceed; reorders them. O(n).
/// \pre not empty, 0 ≤ q ≤ 1; asserted
inline double quantile(std::vector<double>& values, double q) {
  SWARM_ASSERT(!values.empty() && q >= 0.0 && q <= 1.0);
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

}  // namespace swarm::monitor
