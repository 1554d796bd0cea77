// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Guides that robots are stuck on, or that follow the swarm in flight.
#include <cmath>

#include <gtest/gtest.h>

#include "planner_service/roadmap/connect.hpp"
#include "tests/unit/planner_service/methods/crops/crops_worlds.hpp"

namespace swarm::planner {
namespace {

TEST(CropsGuide, LeavesAPathWhereManyAreStuck) {
  // One block in the middle with a passage on either side.
  const World world = World::make({{0, 0}, {20, 20}}, {box(8, 6, 12, 14)}).value();
  int changed_sides = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Rng rng(seed);
    auto guide = CropsGuide::make(world, single(2, 10, 0.5), single(18, 10, 0.5), {}, {}, rng);
    ASSERT_TRUE(guide.has_value());
    const bool was_above = mean_y_at(guide->routes()[0].waypoints, 10.0) > 10.0;

    for (int times = 0; times < 20; ++times) {
      const double y = mean_y_at(guide->routes()[0].waypoints, 10.0);
      if ((y > 10.0) != was_above) break;
      guide->reweight(0, {9.0, y});
    }

    changed_sides += (mean_y_at(guide->routes()[0].waypoints, 10.0) > 10.0) != was_above ? 1 : 0;
    EXPECT_LE(worst_cvar_m(guide->routes()[0].waypoints, world),
              RiskLimit{}.delta_m + kPlanTolerance_m);
  }
  EXPECT_EQ(changed_sides, 10);
}

TEST(CropsGuide, TriplesTheCostOfTheNextEdges) {
  const World world = gap_or_detour();
  Rng rng(2);
  auto guide = CropsGuide::make(world, single(2, 5, 0.5), single(18, 5, 0.5), {}, {}, rng);
  ASSERT_TRUE(guide.has_value());
  const Roadmap before = guide->roadmap();
  const Waypoints path = guide->routes()[0].waypoints;
  ASSERT_GE(path.size(), 7U);

  // Between the second and the third node of the path: its edges 1, 2, 3 and 4.
  guide->reweight(0, 0.5 * (path[1].mean_m() + path[2].mean_m()));

  const auto is_costly = [&](const Vec2& a, const Vec2& b) {
    for (std::size_t i = 1; i <= 4; ++i) {
      if ((path[i].mean_m() == a && path[i + 1].mean_m() == b) ||
          (path[i].mean_m() == b && path[i + 1].mean_m() == a)) {
        return true;
      }
    }
    return false;
  };
  std::size_t costly = 0;
  for (std::uint32_t a = 0; a < before.nodes.size(); ++a) {
    for (std::size_t i = 0; i < before.arcs_of(a).size(); ++i) {
      const Roadmap::Arc& arc = before.arcs_of(a)[i];
      const bool expected = is_costly(before.nodes[a].mean_m(), before.nodes[arc.to].mean_m());
      costly += expected ? 1U : 0U;
      EXPECT_EQ(guide->roadmap().arcs_of(a)[i].length_m,
                expected ? 3.0 * arc.length_m : arc.length_m);
    }
  }
  EXPECT_EQ(costly, 8U);
}

TEST(CropsGuide, KeepsTheOnlyPathHoweverStuck) {
  const Mission mission = crops_scene("spiral");
  auto guide = guide_of(mission, 1);
  ASSERT_TRUE(guide.has_value());

  for (int times = 0; times < 1'000; ++times) guide->reweight(0, {30.0, 20.0});

  ASSERT_EQ(guide->routes().size(), mission.start.components().size());
  for (const Roadmap::Arc& arc : guide->roadmap().arcs) EXPECT_TRUE(std::isfinite(arc.length_m));
}

TEST(CropsGuide, FollowsTheSwarmOnItsSamples) {
  const World world = World::make({{0, 0}, {20, 20}}, {box(8, 6, 12, 14)}).value();
  Rng rng(4);
  auto guide = CropsGuide::make(world, single(2, 10, 0.5), single(18, 10, 0.5), {}, {}, rng);
  ASSERT_TRUE(guide.has_value());
  const bool was_above = mean_y_at(guide->routes()[0].waypoints, 10.0) > 10.0;
  const std::size_t samples = guide->roadmap().nodes.size() - 2;
  for (int times = 0; times < 20; ++times) {
    guide->reweight(0, {9.0, mean_y_at(guide->routes()[0].waypoints, 9.0)});
  }
  for (int times = 0; times < 20; ++times) {
    guide->reweight(0, {9.0, was_above ? 17.0 : 3.0});
  }
  const bool is_above = mean_y_at(guide->routes()[0].waypoints, 10.0) > 10.0;

  const auto start = Mixture::make({{0.5, Gaussian::from_parameters({4, 9}, 0.4, 0.4, 0)},
                                    {0.5, Gaussian::from_parameters({4, 11}, 0.4, 0.4, 0)}});
  const auto moved = guide->move_ends(start.value(), single(17, 10, 0.6));

  ASSERT_TRUE(moved.has_value()) << moved.error().message;
  EXPECT_EQ(guide->roadmap().nodes.size() - 3, samples);
  ASSERT_EQ(guide->routes().size(), 2U);
  for (const Route& route : guide->routes()) {
    EXPECT_EQ(route.waypoints.front().mean_m(), start->components()[route.from].gaussian.mean_m());
    EXPECT_EQ(route.waypoints.back().mean_m(), Vec2(17, 10));
    EXPECT_LE(worst_cvar_m(route.waypoints, world), RiskLimit{}.delta_m + kPlanTolerance_m);
    // Edges whose cost was raised keep the raised cost.
    EXPECT_EQ(mean_y_at(route.waypoints, 10.0) > 10.0, is_above);
  }
  EXPECT_FALSE(guide->move_ends(start.value(), single(10, 10, 0.6)).has_value());
  EXPECT_TRUE(guide->routes().empty());
}

}  // namespace
}  // namespace swarm::planner
