// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/density_grid.hpp"

#include <array>

#include <gtest/gtest.h>

#include "planner_service/flow/plan_density.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

constexpr std::uint32_t kRoutes = 5;
constexpr double kRobots = 60.0;
constexpr double kStep_s = 0.5;

Gaussian random_gaussian(Rng& rng) {
  return Gaussian::from_parameters({uniform(rng, 0, 12), uniform(rng, 0, 12)},
                                   uniform(rng, 0.8, 2.5), uniform(rng, 0.8, 2.5), 0.3);
}

// Routes of three nodes: 3r starts, 3r + 1 is in between, 3r + 2 is the goal; leg 2r leads to the
// node in between and leg 2r + 1 away from it.
std::vector<PlanNode> random_nodes(Rng& rng) {
  std::vector<PlanNode> nodes;
  for (std::uint32_t r = 0; r < kRoutes; ++r) {
    double time_s = 0.0;
    for (int i = 0; i < 3; ++i) {
      nodes.push_back({random_gaussian(rng), MissionTime(time_s), 1.0 / kRoutes});
      time_s += uniform(rng, 2.0, 5.0);
    }
  }
  return nodes;
}

FlowPlan plan_of(const std::vector<PlanNode>& nodes) {
  std::vector<PlanLeg> legs;
  for (std::uint32_t r = 0; r < kRoutes; ++r) {
    legs.push_back({3 * r, 3 * r + 1, 1.0 / kRoutes});
    legs.push_back({3 * r + 1, 3 * r + 2, 1.0 / kRoutes});
  }
  return FlowPlan::make(nodes, legs).value();
}

std::array<std::uint32_t, 2> legs_at(std::uint32_t route) { return {2 * route, 2 * route + 1}; }

// Moves one node in between at random.
std::vector<PlanNode> moved(std::vector<PlanNode> nodes, std::uint32_t route, Rng& rng) {
  nodes[3 * route + 1].gaussian = random_gaussian(rng);
  return nodes;
}

TEST(DensityGrid, RefusesAChangeOnlyIfThePlanWouldExceedTheLimit) {
  Rng rng(1);
  int accepted = 0;
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    const std::vector<PlanNode> nodes = random_nodes(rng);
    DensityGrid grid(plan_of(nodes), kRobots, kStep_s);
    const std::uint32_t route = static_cast<std::uint32_t>(i) % kRoutes;
    const std::vector<PlanNode> next = moved(nodes, route, rng);
    const double limit_per_m2 = uniform(rng, 1.0, 6.0);

    const bool is_taken = grid.try_change(next, legs_at(route), limit_per_m2);

    const FlowPlan plan = plan_of(next);
    if (!is_taken) {
      ++refused;
      // Climbs end within 1 mm of a top, where the density is flat.
      EXPECT_GT(max_density(plan, kRobots, kStep_s).per_m2, limit_per_m2 * (1.0 - 1e-5));
      continue;
    }
    ++accepted;
    // No mean of the changed legs is in a denser region, at any sampled time.
    for (const MissionTime t : density_times(plan, kStep_s)) {
      const PlanNode& from = plan.nodes()[3 * route];
      const PlanNode& to = plan.nodes()[3 * route + 1];
      if (t < from.time || t >= to.time) continue;
      const double share = (t - from.time) / (to.time - from.time);
      const Vec2 mean_m = (1.0 - share) * from.gaussian.mean_m() + share * to.gaussian.mean_m();
      EXPECT_LE(kRobots * plan.mixture_at(t).density(mean_m), limit_per_m2 * (1.0 + 1e-5));
    }
  }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(refused, 50);
}

TEST(DensityGrid, IsAfterAnyChangesAsIfMadeAnew) {
  Rng rng(2);
  std::vector<PlanNode> nodes = random_nodes(rng);
  DensityGrid kept(plan_of(nodes), kRobots, kStep_s);
  int accepted = 0;
  constexpr int kChanges = 300;
  for (int i = 0; i < kChanges; ++i) {
    const auto route = static_cast<std::uint32_t>(rng() % kRoutes);
    const std::vector<PlanNode> next = moved(nodes, route, rng);
    const double limit_per_m2 = uniform(rng, 1.0, 6.0);
    DensityGrid anew(plan_of(nodes), kRobots, kStep_s);

    const bool is_taken = kept.try_change(next, legs_at(route), limit_per_m2);

    ASSERT_EQ(is_taken, anew.try_change(next, legs_at(route), limit_per_m2)) << "change " << i;
    if (!is_taken) continue;
    nodes = next;
    ++accepted;
  }
  EXPECT_GT(accepted, 50);
  EXPECT_LT(accepted, kChanges - 50);
}

TEST(DensityGrid, CountsSourcesAndSinksAtRest) {
  const auto disc = [](double x, double y) { return Gaussian::from_parameters({x, y}, 1, 1, 0); };
  // The second half leaves at 10 s; the first half passes far away, and is then moved onto its
  // start.
  std::vector<PlanNode> nodes{{disc(0, 0), MissionTime(0), 0.5},
                              {disc(20, 40), MissionTime(5), 0.5},
                              {disc(40, 0), MissionTime(9), 0.5},
                              {disc(20, 10), MissionTime(10), 0.5},
                              {disc(20, 80), MissionTime(20), 0.5}};
  const FlowPlan plan = FlowPlan::make(nodes, {{0, 1, 0.5}, {1, 2, 0.5}, {3, 4, 0.5}}).value();
  const double half_per_m2 = 0.5 * kRobots / (2.0 * std::numbers::pi);
  DensityGrid grid(plan, kRobots, kStep_s);
  const std::vector<std::uint32_t> changed{0, 1};

  nodes[1].gaussian = disc(20, 10);
  EXPECT_FALSE(grid.try_change(nodes, changed, 1.9 * half_per_m2));
  EXPECT_TRUE(grid.try_change(nodes, changed, 2.1 * half_per_m2));
  nodes[1].gaussian = disc(20, 80);  // where the second half arrives after the first has left
  EXPECT_TRUE(grid.try_change(nodes, changed, 1.1 * half_per_m2));
}

}  // namespace
}  // namespace swarm::planner
