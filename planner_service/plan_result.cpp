// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/planning/plan_result.hpp"

#include <fmt/format.h>

namespace swarm::planner {

std::string describe(const PlanExcess& excess) {
  return fmt::format("the plan breaks the risk limit by {:.3f} m at obstacle {}, t = {:.1f} s",
                     excess.by_m, excess.obstacle, excess.at.count());
}

}  // namespace swarm::planner
