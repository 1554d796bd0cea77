// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/linalg.hpp"

/// Plane geometry that polygons and worlds share.
namespace swarm {

/// Lengths up to this count as zero [m].
inline constexpr double kTiny_m = 1e-9;

/// z component of a × b: twice the signed area of the triangle 0, a, b; positive if b lies to the
/// left of a.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace swarm
