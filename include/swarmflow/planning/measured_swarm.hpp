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

/// What the planner knows of one robot in flight, from its last status.
struct ReportedRobot {
  RobotId robot;
  Vec2 position_m = Vec2::Zero();
  bool arrived = false;            ///< inside its goal, and at rest there
  double lag_s = 0.0;              ///< behind its reference position, in plan time
  std::uint32_t plan_version = 0;  ///< of the plan it follows; 0: none
  double plan_time_s = 0.0;        ///< of that plan's clock, as the robot has it
  /// Index of the leg it is on in the plan in force, and of the goal component it is led to. Known
  /// for methods with PlanningTraits::uses_places.
  std::optional<std::uint32_t> leg{};
  std::optional<std::uint32_t> goal{};
};

/// Robots that are planned for together, and the Gaussian that stands for them.
struct RobotGroup {
  Gaussian gaussian;
  /// In the order of their shares at the splits of the plan: robots that are close in this order
  /// tend to take the same route.
  std::vector<RobotId> members;
};

/// A swarm in flight, to plan anew for. Refers to objects of the caller.
struct MeasuredSwarm {
  const World& world;
  const Mixture& goal;
  std::span<const ReportedRobot> robots;  ///< at least one
};

/// The groups as a mixture, weighted by their number of robots. \pre no group is empty
Mixture mixture_of(std::span<const RobotGroup> groups);

}  // namespace swarm::planner
