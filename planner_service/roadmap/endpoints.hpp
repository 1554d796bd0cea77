// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// One line for each component of a mixture that breaks the risk limit at its own position:
/// which, at which obstacle, its CVaR against δ, and what would help. Empty when all keep it.
/// `which` is "start" or "goal".
std::string describe_violations(const Mixture& mixture, std::string_view which, const World& world,
                                const RiskLimit& risk);

/// kInfeasible when a component of start or goal breaks the risk limit at its own position, with
/// the lines of describe_violations() for both.
Result<void> check_endpoints(const World& world, const Mixture& start, const Mixture& goal,
                             const RiskLimit& risk);

}  // namespace swarm::planner
