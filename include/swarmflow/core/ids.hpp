// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "swarmflow/core/strong_id.hpp"

namespace swarm {

/// Number of a robot in its mission, 0 … robots.count − 1.
using RobotId = StrongId<struct RobotIdTag, std::uint32_t>;

/// Incarnation of a planner process: the UTC time of its start [ns]. A restarted or stand-by
/// planner publishes under a higher epoch, and receivers prefer the highest one.
using PlannerEpoch = StrongId<struct PlannerEpochTag, std::uint64_t>;

/// Number of a plan within one epoch, from 1; 0 stands for no plan.
using PlanVersion = StrongId<struct PlanVersionTag, std::uint32_t>;

}  // namespace swarm
