// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/world.hpp"
#include "swarmflow/robot/polyline.hpp"
#include "swarmflow/robot/route.hpp"

namespace swarm::agent {

/// The distances of a detour.
struct DetourOptions {
  double radius_m = 0.2;
  double touch_m = 0.3;  ///< a path nearer than this to a body is bent
  double keep_m = 0.5;   ///< surface distance of the bent path to the body
  double scale = 1.0;    ///< of the other distances (body_scale.hpp)
};

DetourOptions detour_options(const RouteOptions& route);

/// Points that lead from a point to another around the bodies of dead robots on the straight line
/// between them, in order, without its ends; empty if the line is free. The
/// detour passes bodies that no robot fits between together, on the shorter side that is free;
/// where neither is, the line stays straight and avoidance is left to the safety filter. O(bodies²)
/// for each body on the line.
std::vector<Vec2> around_bodies(const Vec2& from_m, const Vec2& to_m, const World& world,
                                const DetourOptions& options);

/// The nearest point beside all bodies that a robot can be at, or the point itself if there is
/// none.
Vec2 beside_bodies(const Vec2& point_m, const World& world, const DetourOptions& options);

/// Whether a path, from this arc length on, comes nearer to a body than a bent path does: a body
/// that was not there when the path was made. O(bodies · segments).
bool is_blocked_by_body(const Polyline& path, double from_s_m, const World& world,
                        const DetourOptions& options);

}  // namespace swarm::agent
