// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "swarmflow/robot/polyline.hpp"
#include "swarmflow/robot/schedule.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::agent {

/// One robot's own path through the flow, and when it is to be where on it.
struct Route {
  Polyline path;
  Schedule schedule;
  std::uint32_t sink = 0;  ///< index into FlowPlan::sinks()
  Gaussian goal;           ///< the sink's Gaussian
};

struct RouteOptions {
  double radius_m = 0.2;
  /// The normalised offset is clamped to this Mahalanobis distance: the transport map keeps it, so
  /// a robot that starts in the far tail still ends inside the goal's 99 % ellipse (3.03).
  double offset_max = 2.5;
  double vertex_clearance_m = 1.0;  ///< surface distance kept at the route's corners where possible
  double leg_clearance_m = 0.3;     ///< and along its legs
};

/// The way of a robot that stands at the start of the mission.
///
/// At every split it takes the leg its `share` ∈ [0, 1) falls into, which it then rescales to that
/// leg: with shares stratified over all robots the counts on every leg come out right to within
/// one, without a word said. Its offset y₀ = x₀ − μ rides along the optimal transport maps, y' =
/// Ty, so on each leg it moves in a straight line (swarmprm eq. 3–4); where μ + y would come too
/// close to an obstacle, y is scaled towards 0, where the plan's CVaR promise holds. Deterministic.
Route route_from_start(const FlowPlan& plan, double share, const Vec2& position_m,
                       const World& world, const RouteOptions& options);

/// The way of a robot that is told by the planner, in mid-flight, which source of a new plan is its
/// group's. It begins where the robot is, so nothing jumps; then it goes on as above. \pre `source`
/// is an index into plan.sources()
Route route_from_source(const FlowPlan& plan, std::uint32_t source, double share,
                        const Vec2& position_m, const World& world, const RouteOptions& options);

/// The path of a robot that has no place in the plan yet (it joined late, was restarted, or the
/// planner did not receive it): it joins the flow where a leg's geodesic passes nearest to it in
/// space and, given the plan's time, in time: d² + (Δt / kJoin_s)², d the Mahalanobis distance; in
/// line of sight if any is. From there it goes on as above.
Route route_from_here(const FlowPlan& plan, double share, const Vec2& position_m,
                      const World& world, const RouteOptions& options,
                      std::optional<double> plan_time_s = std::nullopt);
inline constexpr double kJoin_s = 10.0;  ///< this far off in time counts as one σ in space

}  // namespace swarm::agent
