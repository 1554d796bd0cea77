// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "swarmflow/core/strong_id.hpp"

namespace swarm {

/// Robot number, 0 … robots−1.
using RobotId = StrongId<struct RobotIdTag, std::uint32_t>;

/// Life of a planner process: a restarted or stand-by planner publishes under a higher epoch.
using PlannerEpoch = StrongId<struct PlannerEpochTag, std::uint64_t>;

/// Counts the plans within one epoch, from 1.
using PlanVersion = StrongId<struct PlanVersionTag, std::uint32_t>;

}  // namespace swarm
