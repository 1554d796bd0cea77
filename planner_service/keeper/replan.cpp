// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/keeper/replan.hpp"

#include <utility>

#include "swarm_core/mission/placement.hpp"

namespace swarm::planner {
namespace {

// The source of each robot is its group, its share is stratified by its rank in the group.
std::vector<PlanEntry> entries_of(std::span<const RobotGroup> groups, std::uint32_t robot_count) {
  std::vector<PlanEntry> entries(robot_count);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto size = static_cast<std::uint32_t>(groups[g].members.size());
    for (std::uint32_t rank = 0; rank < size; ++rank) {
      const double share = stratified_share(rank, size);
      entries.at(groups[g].members[rank].value()) = {static_cast<std::uint16_t>(g),
                                                     PlanEntry::share_of(share)};
    }
  }
  return entries;
}

}  // namespace

// Measure, plan, then order the members: the order depends on the routes of the plan.
Result<Replan> replan(Planner& planner, const MeasuredSwarm& swarm, std::uint32_t robot_count,
                      const PlanContext& context) {
  PlanningMethod& method = planner.method();
  auto groups = method.measure(swarm);
  if (!groups) return tl::unexpected(groups.error());
  const Mixture start = mixture_of(*groups);
  const Mixture goal = method.goal_from(swarm);
  auto planned = planner.plan({swarm.world, start, goal}, context);
  if (!planned) return tl::unexpected(planned.error());
  method.order_members(*groups, planned->plan, swarm);
  return Replan{*std::move(planned), entries_of(*groups, robot_count)};
}

}  // namespace swarm::planner
