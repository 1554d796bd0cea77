// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner_service/flow/timed_network.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/gaussian.hpp"

namespace swarm::planner {

/// A flow plan with the roadmap node of each of its nodes.
struct TimedPlan {
  FlowPlan plan;
  std::vector<std::uint32_t> roadmap_node;  ///< which node of the roadmap a node of the plan is
};

/// The flow plan of moves on the grid of times. A node of the plan is a node of the roadmap at a
/// step where something comes or goes; waiting in between is one leg from the Gaussian to itself.
/// So a start component that sends its mass in waves is one source at time 0 and a chain of legs
/// that carry the rest; a goal component is a chain that ends in its sink when its last mass comes.
///
/// sources()[i] is start component i, sinks()[j] goal component j. Moves below 1e-9, which only
/// rounding makes, are left out. kBadInput when the plan would not fit a message.
Result<TimedPlan> timed_plan(std::span<const Gaussian> nodes, std::span<const double> supplies,
                             std::span<const double> demands, std::vector<TimedMove> moves,
                             double step_s);

}  // namespace swarm::planner
