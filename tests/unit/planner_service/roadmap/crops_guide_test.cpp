// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/crops_guide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "planner_service/transport/build_plan.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarm_core/mission/mission_file.hpp"

namespace swarm::planner {
namespace {

Polygon box(double x0, double y0, double x1, double y1) {
  return Polygon::make({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}).value();
}

Mixture single(double x, double y, double sigma_m) {
  return Mixture::make({{1.0, Gaussian::from_parameters({x, y}, sigma_m, sigma_m, 0.0)}}).value();
}

Mission crops_scene(const std::string& name) {
  return load_mission(std::string(SWARM_SOURCE_DIR) + "/deploy/missions/crops_" + name + ".yaml")
      .value();
}

Result<CropsGuide> guide_of(const Mission& mission, std::uint64_t seed) {
  Rng rng(seed);
  return CropsGuide::make(mission.world, mission.start, mission.goal, {}, {}, rng);
}

// Largest CVaR on the legs, on a grid.
double worst_cvar_m(const Waypoints& waypoints, const World& world) {
  const double k = cvar_coefficient(RiskLimit{}.alpha);
  double worst_m = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    const Geodesic geodesic(waypoints[i - 1], waypoints[i]);
    for (int t = 0; t <= 100; ++t) {
      worst_m = std::max(worst_m, max_cvar_m(geodesic.at(t / 100.0), world, k));
    }
  }
  return worst_m;
}

double mean_y_at(const Waypoints& waypoints, double x) {
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    const Vec2& a = waypoints[i - 1].mean_m();
    const Vec2& b = waypoints[i].mean_m();
    if ((a.x() - x) * (b.x() - x) > 0.0 || a.x() == b.x()) continue;
    return a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y());
  }
  return std::numeric_limits<double>::quiet_NaN();
}

TEST(CropsGuide, WeighsAPlaceByTheSumOfItsDistances) {
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
      EXPECT_TRUE(build_plan(guide->routes(), starts, goals, 1.25).has_value());
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

  // Start and goal reach farther when they are alone; the samples are enough to tell.
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

// A wall with a gap of 2 m on the direct way; above the wall all is open.
//
//   20  .                 .
//   11  .       ##        .      start (2, 5), goal (18, 5)
//       .       ##        .
//    6  .       ##        .      at the gap's middle, (10, 5): 1 + 1 = 2 m of clearance
//    5  S                 G      above the wall, (10, 14): 3 + 10 = 13 m
//    4  .       ##        .
//    0  .       ##        .
World gap_or_detour() {
  return World::make({{0, 0}, {20, 20}}, {box(9, -1, 11, 4), box(9, 6, 11, 11)}).value();
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
    const auto short_way =
        CropsGuide::make(world, single(2, 5, 0.5), single(18, 5, 0.5), {}, options, rng);

    ASSERT_TRUE(open.has_value() && short_way.has_value());
    EXPECT_GT(mean_y_at(open->routes()[0].waypoints, 10.0), 11.0);
    EXPECT_LT(mean_y_at(short_way->routes()[0].waypoints, 10.0), 6.0);
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

TEST(CropsGuide, LeavesAWayWhereManyAreStuck) {
  // One block in the middle, a way on either side.
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

TEST(CropsGuide, MakesTheNextEdgesThreeTimesAsDear) {
  const World world = gap_or_detour();
  Rng rng(2);
  auto guide = CropsGuide::make(world, single(2, 5, 0.5), single(18, 5, 0.5), {}, {}, rng);
  ASSERT_TRUE(guide.has_value());
  const Roadmap before = guide->roadmap();
  const Waypoints path = guide->routes()[0].waypoints;
  ASSERT_GE(path.size(), 7U);

  // Between the second and the third place of the path: its edges 1, 2, 3 and 4.
  guide->reweight(0, 0.5 * (path[1].mean_m() + path[2].mean_m()));

  const auto is_dear = [&](const Vec2& a, const Vec2& b) {
    for (std::size_t i = 1; i <= 4; ++i) {
      if ((path[i].mean_m() == a && path[i + 1].mean_m() == b) ||
          (path[i].mean_m() == b && path[i + 1].mean_m() == a)) {
        return true;
      }
    }
    return false;
  };
  std::size_t dear = 0;
  for (std::uint32_t a = 0; a < before.nodes.size(); ++a) {
    for (std::size_t i = 0; i < before.arcs_of(a).size(); ++i) {
      const Roadmap::Arc& arc = before.arcs_of(a)[i];
      const bool expected = is_dear(before.nodes[a].mean_m(), before.nodes[arc.to].mean_m());
      dear += expected ? 1U : 0U;
      EXPECT_EQ(guide->roadmap().arcs_of(a)[i].length_m,
                expected ? 3.0 * arc.length_m : arc.length_m);
    }
  }
  EXPECT_EQ(dear, 8U);
}

TEST(CropsGuide, KeepsTheOnlyWayHoweverStuck) {
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
    // What was dear is still dear.
    EXPECT_EQ(mean_y_at(route.waypoints, 10.0) > 10.0, is_above);
  }
  EXPECT_FALSE(guide->move_ends(start.value(), single(10, 10, 0.6)).has_value());
  EXPECT_TRUE(guide->routes().empty());
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
    return build_plan(guide_of(mission, seed)->routes(), 1, 1, 1.25)->digest();
  };

  EXPECT_EQ(digest(7), digest(7));
  EXPECT_NE(digest(7), digest(8));
}

TEST(CropsGuide, SaysWhyThereIsNoPath) {
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
