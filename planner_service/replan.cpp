// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/replan.hpp"

#include <utility>

#include "planner_service/mpc/flow_groups.hpp"
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
                                                     PlanEntry::share_of(share)};
    }
  }
  return entries;
}

std::vector<std::size_t> led_to(const Mixture& goal, std::span<const HeardRobot> robots) {
  std::vector<std::size_t> led(goal.components().size(), 0);
  for (const HeardRobot& robot : robots) {
    if (robot.goal) ++led.at(*robot.goal);
  }
  return led;
}

}  // namespace

Result<Replan> replan(Planner& planner, const World& world, const Mixture& goal,
                      std::span<const HeardRobot> robots, std::uint32_t robot_count, Rng& rng,
                      const StageClock& clock) {
  auto groups = planner.measure(world, goal, robots);
  if (!groups) return tl::unexpected(groups.error());
  const bool steps = planner.method() == Method::kRover;
  const Mixture to =
      steps ? goal_in_robots(goal, led_to(goal, robots), robots.size(), world, planner.risk())
            : goal;
  auto planned = planner.plan({world, mixture_of(*groups), to}, rng, clock);
  if (!planned) return tl::unexpected(planned.error());
  SWARM_ASSERT(planned->plan.sources().size() == groups->size());
  if (steps) order_by_flow(*groups, planned->plan, goal, robots);
  return Replan{*std::move(planned), entries_of(*groups, robot_count)};
}

}  // namespace swarm::planner
