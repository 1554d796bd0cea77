// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>

/// Swarmflow's core: Gaussians, plans, maps, missions, and the types and units they are made of.
///
/// Conventions of all public headers: SI units, with the unit as a suffix of every number that has
/// one (`_m`, `_mps`, `_s`, `_rad`, `_per_m2`); positions and velocities in the world frame ENU (x
/// right, y up), angles counter-clockwise from the x axis. Functions report bad input by Result and
/// check their own preconditions (\\pre) by assertions that are always on and end the program.
/// Objects are not synchronised: different objects may be used by different threads, one object by
/// one thread at a time unless its documentation states otherwise.
namespace swarm {

/// Position [m] or velocity [m/s] in the world frame ENU (x right, y up), or a unit vector.
using Vec2 = Eigen::Vector2d;
/// 2×2 matrix, as a covariance [m²].
using Mat2 = Eigen::Matrix2d;

/// max(x, 0) as ½(x + |x|), without the branch that g++ emits: faster where the sign of x is
/// unpredictable.
inline double positive_part(double x) { return 0.5 * (x + std::abs(x)); }

}  // namespace swarm
