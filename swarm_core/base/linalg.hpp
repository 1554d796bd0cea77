// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace swarm {

using Vec2 = Eigen::Vector2d;  ///< metres or metres per second, world frame ENU (x right, y up)
using Mat2 = Eigen::Matrix2d;

}  // namespace swarm
