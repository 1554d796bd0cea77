// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/planning_registry.hpp"

#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {

void PlanningRegistry::add(std::string name, std::string summary, PlanningFactory factory) {
  const bool is_new =
      entries_.try_emplace(std::move(name), Entry{std::move(summary), std::move(factory)}).second;
  SWARM_ASSERT(is_new);
}

Result<std::unique_ptr<PlanningMethod>> PlanningRegistry::make(const Mission& mission,
                                                               PlanningUse use) const {
  const auto found = entries_.find(mission.planner.method);
  if (found == entries_.end()) {
    std::string known;
    for (const auto& [name, entry] : entries_) known += (known.empty() ? "" : ", ") + name;
    return fail(ErrorCode::kBadInput, fmt::format("planner.method: this program has no method {}; "
                                                  "it has {}",
                                                  mission.planner.method, known));
  }
  return found->second.make(
      {.mission = mission,
       .limits = swarm_limits(mission.robots, mission.safety, mission.control),
       .use = use});
}

}  // namespace swarm::planner
