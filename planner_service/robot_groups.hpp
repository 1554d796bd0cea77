// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "swarm_core/base/ids.hpp"
#include "swarm_core/base/result.hpp"
#include "swarm_core/gmm/mixture.hpp"
#include "swarm_core/risk/cvar.hpp"
#include "swarm_core/world/world.hpp"

namespace swarm::planner {

/// Where a robot said it is.
struct HeardRobot {
  RobotId robot;
  Vec2 position_m = Vec2::Zero();
  bool arrived = false;            ///< inside its goal, and at rest there
  double lag_s = 0.0;              ///< behind its reference position, in plan time
  std::uint32_t plan_version = 0;  ///< of the plan it follows; 0: none
  double plan_time_s = 0.0;        ///< of that plan's clock, as the robot has it
  /// Its place in the plan in force, where the planner knows it: the leg it is on, and the
  /// component of the goal it is led to.
  std::optional<std::uint32_t> leg{};
  std::optional<std::uint32_t> goal{};
};

/// Robots that stand together, and a Gaussian for them that keeps the risk limit.
struct RobotGroup {
  Gaussian gaussian;
  std::vector<RobotId> members;  ///< in order of their place along the group's longer axis
};

struct GroupOptions {
  double radius_m = 6.0;        ///< of a group, around its first robot
  std::size_t groups_max = 64;  ///< above, the radius grows until they are fewer
  double sigma_floor_m = 0.5;   ///< a group is at least this wide, where there is room
  double sigma_least_m = 0.1;   ///< … and squeezed no further than this where there is not
};

/// The measured state of the swarm as a mixture: groups of robots within the radius of their first
/// one and in its line of sight. Robots that arrived form a group for each component of `goal` they
/// are in, with its Gaussian, so that they may stay.
///
/// Means too near an obstacle are pushed out and shapes squeezed as far as the limit asks for.
/// kInfeasible names the place where no Gaussian keeps it. \pre some robots
/// O(robots · groups) visibility tests.
Result<std::vector<RobotGroup>> group_robots(std::span<const HeardRobot> robots, const World& world,
                                             const Mixture& goal, const RiskLimit& risk,
                                             const GroupOptions& options);

/// The groups as a mixture, weighted by their robots.
Mixture mixture_of(std::span<const RobotGroup> groups);

}  // namespace swarm::planner
