// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/robot/polyline.hpp"
#include "swarmflow/robot/schedule.hpp"

namespace swarm::agent {

/// One robot's own path through the plan, and when it is to be where on it.
struct Route {
  Polyline path;           ///< at least one vertex, the last one the robot's position in the goal
  Schedule schedule;       ///< arc length on `path` as a function of plan time, at least one entry
  std::uint32_t sink = 0;  ///< its goal, as an index into FlowPlan::sinks()
  Gaussian goal;           ///< the Gaussian of that sink
};

/// How a route keeps off obstacles.
struct RouteOptions {
  double radius_m = 0.2;  ///< radius of the robot [m]
  /// Largest Mahalanobis distance of a robot's offset from a Gaussian's mean; a larger offset is
  /// shortened to it. Transport maps keep that distance, so a robot that starts in the far tail
  /// still ends inside the goal's 99 % ellipse (3.03).
  double offset_max = 2.5;
  /// Distance between surfaces kept at the vertices of the route where possible [m].
  double vertex_clearance_m = 1.0;
  double leg_clearance_m = 0.3;  ///< the same along its legs [m]
  double scale = 1.0;            ///< factor on the distances kept to bodies of dead robots
};

/// The route of a robot that is at its position at the start of the mission.
///
/// At every split the robot takes the leg that its share falls into, and rescales the share to that
/// leg: with the shares (id + ½)/N the number of robots on every leg is right to within one,
/// without communication. Its offset y₀ = x₀ − μ follows the optimal transport maps,
///
///   y' = T y,   T = Σ₁⁻¹ # Σ₂ (geometric mean)                     [SwarmPRM, eq. 3–4]
///
/// so on each leg it moves in a straight line. Where μ + y would come too near an obstacle, y is
/// scaled towards 0, where the plan keeps its risk limit. Bodies of dead robots only bend the
/// path, and move its end within the goal's 99 % ellipse where there is room.
/// Deterministic; allocates; O(vertices) distance queries.
/// \param plan the plan
/// \param share the robot's share in [0, 1)
/// \param position_m its position [m]
/// \param world the map
/// \param options radius and clearances
/// \pre the plan is not empty
Route route_from_start(const FlowPlan& plan, double share, const Vec2& position_m,
                       const World& world, const RouteOptions& options);

/// The route of a robot under way into a new plan, in which the planner has assigned it to a
/// source. It begins at the robot's position, so no reference jumps, and continues as
/// route_from_start().
/// \param plan the plan
/// \param source the robot's source, as an index into plan.sources()
/// \param share the robot's share among those of its source, in [0, 1)
/// \param position_m its position [m]
/// \param world the map
/// \param options radius and clearances
/// \pre source < plan.sources().size(); not checked
Route route_from_source(const FlowPlan& plan, std::uint32_t source, double share,
                        const Vec2& position_m, const World& world, const RouteOptions& options);

/// The route of a robot without an assigned source (it joined late, was restarted, or the planner
/// did not receive its status). It joins the flow at the point of a leg's geodesic that is nearest
/// in space and time,
///
///   min d² + (Δt / kJoin_s)²,   d the Mahalanobis distance of the robot
///
/// among points in line of sight if there are any, and continues as route_from_start(). Seventeen
/// points per leg are tested, so O(legs) geodesics and visibility queries.
/// \param plan the plan
/// \param share the robot's share in [0, 1), for the splits that follow
/// \param position_m its position [m]
/// \param world the map
/// \param options radius and clearances
/// \param plan_time_s τ of the plan's clock [s]; empty: only the distance in space counts
/// \pre the plan has a leg; not checked
Route route_from_here(const FlowPlan& plan, double share, const Vec2& position_m,
                      const World& world, const RouteOptions& options,
                      std::optional<double> plan_time_s = std::nullopt);
/// In route_from_here() a difference of this much plan time counts like a distance of one σ [s].
inline constexpr double kJoin_s = 10.0;

}  // namespace swarm::agent
