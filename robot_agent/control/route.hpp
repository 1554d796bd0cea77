// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "robot_agent/control/polyline.hpp"
#include "swarm_core/plan/flow_plan.hpp"
#include "swarm_core/world/world.hpp"

namespace swarm::agent {

/// A Gaussian on a robot's way, with the robot's place in it.
struct Station {
  Gaussian gaussian;
  Vec2 offset_m = Vec2::Zero();  ///< from the mean, as transported
  double mass_out = 0.0;         ///< of the leg it leaves by; of the node at the end of the way
  double at_m = 0.0;             ///< arc length on the path
};

/// One robot's own way through the flow.
struct Route {
  Polyline path;
  std::vector<Station> stations;
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

/// The way of a robot that the planner did not hear when it made a new plan: it joins the leg whose
/// geodesic passes nearest (in Mahalanobis distance, and in line of sight if any is), from where it
/// is, then goes on as above.
Route route_from_here(const FlowPlan& plan, double share, const Vec2& position_m,
                      const World& world, const RouteOptions& options);

}  // namespace swarm::agent
