// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace swarm {

using Vec2 = Eigen::Vector2d;  ///< metres or metres per second, world frame ENU (x right, y up)
using Mat2 = Eigen::Matrix2d;

/// max(x, 0) without the branch that g++ makes of it, for where the sign of x is a coin toss.
inline double positive_part(double x) { return 0.5 * (x + std::abs(x)); }

}  // namespace swarm
