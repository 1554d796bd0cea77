// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/crops/crops_guide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "planner_service/flow/build_plan.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "tests/unit/planner_service/methods/crops/crops_worlds.hpp"

namespace swarm::planner {
namespace {

TEST(CropsGuide, WeighsAPointByTheSumOfItsDistances) {
  const auto letter_l = Polygon::make({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 6}, {0, 6}}).value();
  const World world = World::make({{-10, -10}, {20, 20}}, {letter_l, Circle{{10, 3}, 2}}).value();

  // To the L's inner walls 1 and 2 m, the nearer counts once; to the circle 7 m, less its radius.
  EXPECT_NEAR(clearance_weight(world, {3, 3}, 1.0), 2.0 + 5.0, 1e-12);
  EXPECT_NEAR(clearance_weight(world, {3, 3}, 3.0), 343.0, 1e-9);
  EXPECT_NEAR(clearance_weight(world, {3, 3}, 0.0), 1.0, 1e-12);
  EXPECT_EQ(clearance_weight(World::make({{0, 0}, {1, 1}}, {}).value(), {0, 0}, 3.0), 1.0);
  EXPECT_DOUBLE_EQ(guide_cost(6.0, 3.0, 2.0), 3.0);
  EXPECT_DOUBLE_EQ(guide_cost(6.0, 2.0, 3.0), 3.0);
}

TEST(CropsGuide, GuidesThroughTheScenesOfItsCodeOnEverySeed) {
  for (const std::string name : {"scene1", "scene3", "s", "spiral"}) {
    const Mission mission = crops_scene(name);
    for (std::uint64_t seed = 1; seed <= 21; ++seed) {
      const auto guide = guide_of(mission, seed);

      ASSERT_TRUE(guide.has_value()) << name << " seed " << seed << ": " << guide.error().message;
      const std::size_t starts = mission.start.components().size();
      const std::size_t goals = mission.goal.components().size();
      ASSERT_EQ(guide->routes().size(), std::max(starts, goals));
      double mass = 0.0;
      for (const Route& route : guide->routes()) {
        mass += route.mass;
        EXPECT_LE(worst_cvar_m(route.waypoints, mission.world),
                  RiskLimit{}.delta_m + kPlanTolerance_m)
            << name << " seed " << seed;
      }
      EXPECT_NEAR(mass, 1.0, 1e-9);
      EXPECT_TRUE(build_plan(guide->routes(), starts, goals, {1.25}).has_value());
    }
  }
}

TEST(CropsGuide, KeepsOffTheBoundsAsOffObstacles) {
  // Beside the block a gap of 0.85 m to the bounds, on its other side one of 4 m.
  const World world = World::make({{0, 0}, {20, 20}}, {box(0.85, 9, 16, 11)}).value();
  CropsOptions options;
  options.clearance_power = 0.0;  // the shortest
  Rng rng(1);

  const auto guide =
      CropsGuide::make(world, single(2.5, 4, 0.5), single(2.5, 16, 0.5), {}, options, rng);

  ASSERT_TRUE(guide.has_value()) << guide.error().message;
  double farthest_x_m = 0.0;
  for (const Gaussian& g : guide->routes()[0].waypoints) {
    farthest_x_m = std::max(farthest_x_m, g.mean_m().x());
  }
  EXPECT_GT(farthest_x_m, 16.0);
}

TEST(CropsGuide, IsTheUnionOfEachNodesNearestVisibleNeighbours) {
  const Mission mission = crops_scene("s");
  CropsOptions options;
  options.neighbours_max = 6;
  Rng rng(3);
  const auto guide = CropsGuide::make(mission.world, mission.start, mission.goal, {}, options, rng);
  ASSERT_TRUE(guide.has_value()) << guide.error().message;
  const Roadmap& graph = guide->roadmap();
  const double clearance_m = cvar_coefficient(0.05) * options.sigma_min_m + 0.2;
  const std::size_t n = graph.nodes.size();

  // Start and goal reach farther when they are isolated; it is enough to compare the samples.
  std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
  for (std::uint32_t a = 2; a < n; ++a) {
    const Vec2& from = graph.nodes[a].mean_m();
    EXPECT_GT(mission.world.distance_m(from), options.clearance_min_m);
    std::vector<std::pair<double, std::uint32_t>> visible;
    for (std::uint32_t b = 0; b < n; ++b) {
      const Vec2& to = graph.nodes[b].mean_m();
      const double length_m = (to - from).norm();
      if (a == b || length_m > options.connection_radius_m) continue;
      if (mission.world.segment_is_free(from, to, clearance_m)) visible.emplace_back(length_m, b);
    }
    std::sort(visible.begin(), visible.end());
    visible.resize(std::min<std::size_t>(visible.size(), options.neighbours_max));
    for (const auto& [length_m, b] : visible) {
      if (b >= 2) expected.emplace(std::min(a, b), std::max(a, b));
    }
  }
  std::set<std::pair<std::uint32_t, std::uint32_t>> found;
  for (std::uint32_t a = 2; a < n; ++a) {
    for (const Roadmap::Arc& arc : graph.arcs_of(a)) {
      if (arc.to < 2) continue;
      found.emplace(std::min(a, arc.to), std::max(a, arc.to));
      const double length_m = (graph.nodes[a].mean_m() - graph.nodes[arc.to].mean_m()).norm();
      const double weight =
          std::min(clearance_weight(mission.world, graph.nodes[a].mean_m(), 3.0),
                   clearance_weight(mission.world, graph.nodes[arc.to].mean_m(), 3.0));
      // The distance comes from W₂, which loses 1e-8 m in a cancelled difference of traces.
      EXPECT_NEAR(arc.length_m, length_m / weight, 1e-6 * arc.length_m);
    }
  }
  EXPECT_EQ(found, expected);
}

TEST(CropsGuide, PrefersClearanceOverLength) {
  // Straight 16 m, around the wall at least 2·√(8² + 6²) = 20 m. Cubed, the gap's edges cost
  // (13/2)³ = 275 times as much a metre as those above the wall; with p = 0 length alone counts.
  const World world = gap_or_detour();
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    CropsOptions options;
    Rng rng(seed);
    const auto open =
        CropsGuide::make(world, single(2, 5, 0.5), single(18, 5, 0.5), {}, options, rng);
    options.clearance_power = 0.0;
    const auto short_path =
        CropsGuide::make(world, single(2, 5, 0.5), single(18, 5, 0.5), {}, options, rng);

    ASSERT_TRUE(open.has_value() && short_path.has_value());
    EXPECT_GT(mean_y_at(open->routes()[0].waypoints, 10.0), 11.0);
    EXPECT_LT(mean_y_at(short_path->routes()[0].waypoints, 10.0), 6.0);
  }
}

TEST(CropsGuide, TakesTheCheapestPathOfItsGraph) {
  const World world = gap_or_detour();
  Rng rng(5);
  CropsOptions options;
  options.samples = 80;
  const auto start = Mixture::make({{0.5, Gaussian::from_parameters({2, 4}, 0.4, 0.4, 0)},
                                    {0.5, Gaussian::from_parameters({3, 15}, 0.4, 0.4, 0)}});
  const auto guide = CropsGuide::make(world, start.value(), single(18, 5, 0.5), {}, options, rng);
  ASSERT_TRUE(guide.has_value());
  const Roadmap& graph = guide->roadmap();
  // Bellman and Ford from the goal, node 2.
  std::vector<double> cost(graph.nodes.size(), std::numeric_limits<double>::infinity());
  cost[2] = 0.0;
  for (std::size_t round = 0; round < graph.nodes.size(); ++round) {
    for (std::uint32_t a = 0; a < graph.nodes.size(); ++a) {
      for (const Roadmap::Arc& arc : graph.arcs_of(a)) {
        cost[a] = std::min(cost[a], cost[arc.to] + arc.length_m);
      }
    }
  }

  ASSERT_EQ(guide->routes().size(), 2U);
  for (const Route& route : guide->routes()) {
    EXPECT_NEAR(route.mass, 0.5, 1e-9);
    double path_cost = 0.0;
    for (std::size_t i = 1; i < route.waypoints.size(); ++i) {
      const Vec2& a = route.waypoints[i - 1].mean_m();
      const Vec2& b = route.waypoints[i].mean_m();
      path_cost += guide_cost((b - a).norm(), clearance_weight(world, a, 3.0),
                              clearance_weight(world, b, 3.0));
    }
    EXPECT_NEAR(path_cost, cost[route.from], 1e-6 * path_cost);
  }
}

TEST(CropsGuide, ContractsInPlaceWhereTheFirstLegIsTight) {
  // A flat start before a wall with a door of 1.6 m.
  const World world =
      World::make({{0, 0}, {20, 20}}, {box(0, 8, 9.2, 9), box(10.8, 8, 20, 9)}).value();
  const auto flat = Mixture::make({{1.0, Gaussian::from_parameters({10, 6}, 1.5, 0.8, 0)}}).value();
  CropsOptions options;
  options.clearance_power = 0.0;
  options.samples = 100;
  std::size_t contracted = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(seed);

    const auto guide = CropsGuide::make(world, flat, single(10, 14, 1.0), {}, options, rng);

    ASSERT_TRUE(guide.has_value()) << guide.error().message;
    const Waypoints& waypoints = guide->routes()[0].waypoints;
    EXPECT_LE(worst_cvar_m(waypoints, world), RiskLimit{}.delta_m + kPlanTolerance_m);
    contracted += waypoints[1].mean_m() == waypoints[0].mean_m() ? 1U : 0U;
    const auto narrowest = std::min_element(
        waypoints.begin(), waypoints.end(),
        [](const auto& a, const auto& b) { return a.min_sigma_m() < b.min_sigma_m(); });
    // The door: half of 1.6 m less the robots' 0.2 m, by k(0.05) = 2.0627.
    EXPECT_LE(narrowest->min_sigma_m(), 0.6 / 2.0627);
    EXPECT_GE(narrowest->min_sigma_m(), options.sigma_min_m - 1e-6);
  }
  EXPECT_GT(contracted, 0U);  // not all first legs are tight
}

TEST(CropsGuide, AddsSamplesUntilAllIsJoined) {
  const Mission mission = crops_scene("scene3");
  CropsOptions options;
  options.samples = 100;
  options.rounds_max = 50;
  Rng rng(1);

  const auto guide = CropsGuide::make(mission.world, mission.start, mission.goal, {}, options, rng);

  ASSERT_TRUE(guide.has_value()) << guide.error().message;
  const std::size_t ends = mission.start.components().size() + mission.goal.components().size();
  const std::size_t samples = guide->roadmap().nodes.size() - ends;
  EXPECT_GT(samples, 100U);
  EXPECT_EQ((samples - 100) % 51, 0U);  // rounds of N/2 + 1
}

TEST(CropsGuide, RepeatsItselfForTheSameSeedOnly) {
  const Mission mission = crops_scene("scene1");
  const auto digest = [&](std::uint64_t seed) {
    return build_plan(guide_of(mission, seed)->routes(), 1, 1, {1.25})->digest();
  };

  EXPECT_EQ(digest(7), digest(7));
  EXPECT_NE(digest(7), digest(8));
}

TEST(CropsGuide, ReportsWhyThereIsNoPath) {
  const World walled = World::make({{0, 0}, {20, 20}}, {box(9, -1, 11, 21)}).value();
  const auto both_sides = Mixture::make({{0.5, Gaussian::from_parameters({17, 5}, 0.4, 0.4, 0)},
                                         {0.5, Gaussian::from_parameters({3, 15}, 0.4, 0.4, 0)}});
  const World full = World::make({{0, 0}, {20, 20}}, {box(-1, 6, 21, 21), box(-1, -1, 21, 4)})
                         .value();  // a corridor of 2 m, where start and goal fit but no sample
  CropsOptions wide;
  wide.clearance_min_m = 1.5;
  wide.connection_radius_m = 1.0;
  const auto message = [](const World& world, const Mixture& start, const Mixture& goal,
                          const CropsOptions& options) {
    Rng rng(1);
    const auto guide = CropsGuide::make(world, start, goal, {}, options, rng);
    EXPECT_FALSE(guide.has_value());
    if (guide) return std::string();
    EXPECT_EQ(guide.error().code, ErrorCode::kInfeasible);
    return guide.error().message;
  };

  const std::string apart = message(walled, single(2, 5, 0.5), both_sides.value(), {});
  const std::string no_room = message(full, single(2, 5, 0.2), single(18, 5, 0.2), wide);
  const std::string too_near = message(walled, single(8, 5, 0.5), single(2, 5, 0.5), {});

  EXPECT_NE(apart.find("0 -> 0"), std::string::npos) << apart;
  EXPECT_EQ(apart.find("0 -> 1"), std::string::npos) << apart;
  EXPECT_NE(apart.find("planner.samples"), std::string::npos) << apart;
  EXPECT_NE(no_room.find("0 samples"), std::string::npos) << no_room;
  EXPECT_NE(too_near.find("start component 0"), std::string::npos) << too_near;
}

}  // namespace
}  // namespace swarm::planner
