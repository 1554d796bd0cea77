// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/planning/measured_swarm.hpp"

namespace swarm::planner {

/// How wide groups are.
struct GroupOptions {
  double radius_m = 6.0;        ///< of a group, around its first robot
  std::size_t groups_max = 64;  ///< above, the radius grows until they are fewer
  double sigma_floor_m = 0.5;   ///< a group is at least this wide, where there is room
  double sigma_least_m = 0.1;   ///< a group is never narrower than this, even without room
};

/// The measured state of the swarm as a mixture: groups of robots within the radius of their first
/// one and in its line of sight. Robots that arrived form a group for each goal component they are
/// in, with its Gaussian, so that they may stay.
///
/// Means too near an obstacle are pushed out and shapes squeezed as far as the limit requires.
/// kInfeasible names the position where no Gaussian keeps it. \pre some robots O(robots · groups)
/// visibility tests.
Result<std::vector<RobotGroup>> group_robots(const MeasuredSwarm& swarm, const RiskLimit& risk,
                                             const GroupOptions& options);

/// Index of the goal component with this mean, if any.
std::optional<std::uint32_t> component_at(const Mixture& goal, const Vec2& mean_m);

}  // namespace swarm::planner
