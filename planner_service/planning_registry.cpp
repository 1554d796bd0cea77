// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/planning/planning_registry.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {

// All methods share one section of the mission: an option of two methods has to be the same for
// both.
void PlanningRegistry::add(PlanningEntry entry) {
  SWARM_ASSERT(entry.make && find_component(specs(), entry.spec.name) == nullptr);
  for (const OptionSpec& option : entry.spec.options) {
    for (const PlanningEntry& other : entries_) {
      const auto& theirs = other.spec.options;
      SWARM_ASSERT(std::all_of(theirs.begin(), theirs.end(), [&](const OptionSpec& o) {
        return o.key != option.key || o == option;
      }));
    }
  }
  entries_.push_back(std::move(entry));
}

Components PlanningRegistry::specs() const {
  Components specs;
  for (const PlanningEntry& entry : entries_) specs.push_back(entry.spec);
  return specs;
}

Catalogue PlanningRegistry::catalogue() const {
  return {
      .planning_methods = specs(), .control_methods = {}, .drivers = {}, .robots_are_open = true};
}

// Makes the method that the mission names; the error lists the names there are.
Result<std::unique_ptr<PlanningMethod>> PlanningRegistry::make(const Mission& mission,
                                                               PlanningUse use) const {
  const auto found = std::find_if(
      entries_.begin(), entries_.end(),
      [&](const PlanningEntry& entry) { return entry.spec.name == mission.planner.method; });
  if (found == entries_.end()) {
    std::string known;
    for (const PlanningEntry& entry : entries_) {
      known += (known.empty() ? "" : ", ") + entry.spec.name;
    }
    return fail(ErrorCode::kBadInput, fmt::format("planner.method: this program has no method {}; "
                                                  "it has {}",
                                                  mission.planner.method, known));
  }
  return found->make({.mission = mission,
                      .limits = swarm_limits(mission.robots, mission.safety, mission.control),
                      .use = use});
}

}  // namespace swarm::planner
