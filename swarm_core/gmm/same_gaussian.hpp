// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/gaussian.hpp"

namespace swarm {

/// Whether mean and covariance are exactly equal, as those of a copy are.
inline bool same(const Gaussian& a, const Gaussian& b) {
  return a.mean_m() == b.mean_m() && a.covariance_m2() == b.covariance_m2();
}

}  // namespace swarm
