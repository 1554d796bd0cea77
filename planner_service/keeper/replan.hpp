// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "planner_service/groups/plan_entry.hpp"
#include "planner_service/planner.hpp"
#include "swarmflow/planning/measured_swarm.hpp"
#include "swarmflow/planning/plan_request.hpp"
#include "swarmflow/planning/plan_result.hpp"

namespace swarm::planner {

/// A plan, and how robots enter it.
struct Replan {
  PlanResult planned;
  std::vector<PlanEntry> entries;  ///< by robot id; empty = as in the mission's first plan
};

/// Plans anew from where the robots are: the measured mixture of their groups is the start. Each
/// robot is given the group it is in and its share there, so that the counts on all legs come out
/// right to within one robot for every source with a split, as at the start of a mission; drawing
/// by id alone would not: the robots of a group are no fair sample of all ids. Robots that did not
/// report enter anywhere. \pre ids are below `robot_count`
Result<Replan> replan(Planner& planner, const MeasuredSwarm& swarm, std::uint32_t robot_count,
                      const PlanContext& context);

}  // namespace swarm::planner
