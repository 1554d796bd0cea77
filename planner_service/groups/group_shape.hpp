// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/planning/measured_swarm.hpp"

/// A group of robots as a Gaussian.
namespace swarm::planner {

/// Robots of a group; they belong to the caller.
using Members = std::vector<const ReportedRobot*>;

/// Mean and covariance of the members' positions, the latter with σ² I added, since a single robot
/// has no spread of its own. \pre some members
Gaussian shape_of(const Members& members, double sigma_floor_m);

/// Sorts members along the longer axis of a Gaussian.
void sort_along_axis(Members& members, const Gaussian& gaussian);

/// Their ids, in their order.
std::vector<RobotId> ids_of(const Members& members);

}  // namespace swarm::planner
