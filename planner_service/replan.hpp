// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "planner_service/planner.hpp"
#include "planner_service/robot_groups.hpp"

namespace swarm::planner {

/// Where a robot enters a plan that was made while it moved.
struct PlanEntry {
  static constexpr std::uint16_t kAnywhere = 0xFFFF;
  std::uint16_t source = kAnywhere;  ///< index into FlowPlan::sources()
  std::uint16_t share = 0;           ///< / 65536: its place in the draws at the splits behind

  static std::uint16_t share_of(double share) {
    return static_cast<std::uint16_t>(share * 65536.0);
  }
};

struct Replan {
  PlanResult planned;
  std::vector<PlanEntry> entries;  ///< by robot id; empty = as in the mission's first plan
};

/// Plans anew from where the robots are: the measured mixture of their groups is the start. Each
/// robot is told the group it is in and its place there, so that the counts on all legs come out
/// right to within one robot for every source with a split, as at the start of a mission; drawing
/// by id alone would not: the robots of a group are no fair sample of all ids. Robots that were not
/// heard enter where they like. \pre ids are below `robot_count`; some robots
Result<Replan> replan(Planner& planner, const World& world, const Mixture& goal,
                      std::span<const HeardRobot> robots, std::uint32_t robot_count, Rng& rng,
                      const StageClock& clock);

}  // namespace swarm::planner
