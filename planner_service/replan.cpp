// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/replan.hpp"

#include <utility>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/mission/placement.hpp"

namespace swarm::planner {
namespace {

std::vector<PlanEntry> entries_of(std::span<const RobotGroup> groups, std::uint32_t robot_count) {
  std::vector<PlanEntry> entries(robot_count);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto size = static_cast<std::uint32_t>(groups[g].members.size());
    for (std::uint32_t rank = 0; rank < size; ++rank) {
      const double share = stratified_share(rank, size);
      entries.at(groups[g].members[rank].value()) = {static_cast<std::uint16_t>(g),
                                                     static_cast<std::uint16_t>(share * 65536.0)};
    }
  }
  return entries;
}

}  // namespace

Result<Replan> replan(Planner& planner, const World& world, const Mixture& goal,
                      std::span<const HeardRobot> robots, std::uint32_t robot_count, Rng& rng,
                      const StageClock& clock) {
  const auto groups = planner.measure(world, goal, robots);
  if (!groups) return tl::unexpected(groups.error());
  auto planned = planner.plan({world, mixture_of(*groups), goal}, rng, clock);
  if (!planned) return tl::unexpected(planned.error());
  SWARM_ASSERT(planned->plan.sources().size() == groups->size());
  return Replan{*std::move(planned), entries_of(*groups, robot_count)};
}

}  // namespace swarm::planner
