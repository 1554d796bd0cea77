// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// What the planner knows of one robot under way, from its last status.
struct ReportedRobot {
  RobotId robot;                   ///< its number
  Vec2 position_m = Vec2::Zero();  ///< measured position, world frame [m]
  bool arrived = false;            ///< at its final position, by its control method (mode kArrived)
  double lag_s = 0.0;  ///< plan time by which it is behind its reference; negative if ahead [s]
  std::uint32_t plan_version = 0;  ///< version of the plan it follows; 0: none
  double plan_time_s = 0.0;        ///< time of that plan's clock, as the robot knows it [s]
  /// Leg of the plan in force that the robot is on, as an index into FlowPlan::legs(). Set only for
  /// methods with PlanningTraits::uses_positions, and only for robots that the planner has placed.
  std::optional<std::uint32_t> leg{};
  /// Component of the goal mixture that the robot's route leads to; set as `leg` is.
  std::optional<std::uint32_t> goal{};
};

/// Robots that are planned for together: one source of the next plan.
struct RobotGroup {
  Gaussian gaussian;  ///< represents their positions; a component of the start mixture
  /// The robots, in the order of their shares at the splits of the plan: member i of n has the
  /// share (i + ½)/n, so robots that are close in this order tend to take the same route.
  std::vector<RobotId> members;
};

/// A swarm under way, to be planned for from where it is. Refers to objects of the caller, valid
/// during the call.
struct MeasuredSwarm {
  const World& world;   ///< the map to plan in
  const Mixture& goal;  ///< the goal in force: the mission's, or that of a `goto`
  /// Robots with a recent status, by ascending id; at least one.
  std::span<const ReportedRobot> robots;
  double length_scale = 1.0;  ///< as SwarmLimits::length_scale
};

/// The groups as a mixture, component i being group i with its share of all robots as its weight.
/// Allocates. \pre at least one group, and none of them is empty; asserted
Mixture mixture_of(std::span<const RobotGroup> groups);

}  // namespace swarm::planner
