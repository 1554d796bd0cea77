// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/live_roadmap.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "planner_service/roadmap/connect.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

using Edges = std::map<std::pair<std::uint32_t, std::uint32_t>, double>;

Edges edges_of(const Roadmap& roadmap) {
  Edges edges;
  for (std::uint32_t a = 0; a < roadmap.nodes.size(); ++a) {
    for (const Roadmap::Arc& arc : roadmap.arcs_of(a)) edges[{a, arc.to}] = arc.length_m;
  }
  return edges;
}

std::vector<Gaussian> terminals_of(const test::StandinScene& scene) {
  std::vector<Gaussian> terminals;
  for (const Mixture* mixture : {&scene.start, &scene.goal}) {
    for (const auto& component : mixture->components()) terminals.push_back(component.gaussian);
  }
  return terminals;
}

World with(const World& world, std::vector<Obstacle> obstacles) {
  return World::make(world.bounds_m(), std::move(obstacles)).value();
}

// The roadmap that connect() builds from the same nodes in the same world, without earlier results.
void expect_as_from_scratch(const LiveRoadmap& live, std::size_t terminals,
                            const LiveRoadmapOptions& options) {
  const Roadmap kept = live.roadmap();
  EdgeChecker checker(live.world(), options.risk);
  const Roadmap fresh = connect(kept.nodes, options.connection_radius_m, checker, terminals);

  EXPECT_EQ(edges_of(kept), edges_of(fresh));
}

Obstacle random_obstacle(Rng& rng) {
  const Vec2 at(uniform(rng, 5, 195), uniform(rng, 5, 155));
  if (uniform01(rng) < 0.5) return Circle{at, uniform(rng, 0.5, 8.0)};
  const double w = uniform(rng, 1, 12);
  const double h = uniform(rng, 1, 12);
  // An L: two convex parts.
  return Polygon::make({at, at + Vec2(2 * w, 0), at + Vec2(2 * w, h), at + Vec2(w, h),
                        at + Vec2(w, 2 * h), at + Vec2(0, 2 * h)})
      .value();
}

TEST(LiveRoadmap, IsAsFromScratchAfterAnyChanges) {
  const auto scene = test::standin_scene();
  for (const SamplerKind kind : {SamplerKind::kFit, SamplerKind::kUniform}) {
    LiveRoadmapOptions options;
    options.samples = 250;
    options.sampler.kind = kind;
    Rng rng(7);
    std::vector<Gaussian> terminals = terminals_of(scene);
    std::vector<Obstacle> obstacles = scene.world.obstacles();
    LiveRoadmap live(scene.world, terminals, options, rng);
    expect_as_from_scratch(live, terminals.size(), options);
    std::size_t lost = 0;
    for (int step = 0; step < 60; ++step) {
      const auto pick =
          static_cast<std::size_t>(uniform01(rng) * static_cast<double>(obstacles.size()));
      switch (static_cast<int>(uniform(rng, 0, 6))) {
        case 0:
        case 1:
          obstacles.push_back(random_obstacle(rng));
          break;
        case 2:
          if (!obstacles.empty())
            obstacles.erase(obstacles.begin() + static_cast<std::ptrdiff_t>(pick));
          break;
        case 3:
          if (!obstacles.empty()) obstacles[pick] = random_obstacle(rng);
          break;
        case 4:  // another goal, sometimes a wide one, sometimes one more or less
          terminals.back() = Gaussian::from_parameters(
              {uniform(rng, 10, 190), uniform(rng, 10, 150)}, uniform(rng, 1, 12), 3.0, 0.1);
          if (terminals.size() > 5) terminals.erase(terminals.begin() + 2);
          break;
        default:
          terminals.insert(terminals.begin() + 1,
                           Gaussian::from_parameters({uniform(rng, 10, 190), uniform(rng, 10, 150)},
                                                     2.0, 2.0, 0.0));
          std::swap(terminals.front(), terminals.back());
          std::reverse(obstacles.begin(), obstacles.end());  // another order is no change
          break;
      }

      live.update(with(scene.world, obstacles), terminals, rng);

      expect_as_from_scratch(live, terminals.size(), options);
      lost += live.work().samples_lost;
      const Roadmap roadmap = live.roadmap();
      ASSERT_GE(roadmap.nodes.size(), terminals.size());
      for (std::size_t i = 0; i < terminals.size(); ++i) {
        EXPECT_EQ(roadmap.nodes[i].mean_m(), terminals[i].mean_m());
      }
      for (std::size_t i = terminals.size(); i < roadmap.nodes.size(); ++i) {
        EXPECT_TRUE(in_free(roadmap.nodes[i], live.world(), cvar_coefficient(options.risk.alpha),
                            options.risk.delta_m));
        EXPECT_TRUE(scene.world.bounds_m().contains(roadmap.nodes[i].mean_m()));
      }
      if (HasFailure()) return;
    }
    EXPECT_GT(lost, 10U);
  }
}

TEST(LiveRoadmap, ChecksNothingWhenNothingHasChanged) {
  const auto scene = test::standin_scene();
  Rng rng(1);
  LiveRoadmap live(scene.world, terminals_of(scene), {}, rng);
  EXPECT_GT(live.work().edges_checked, 3000U);
  const Edges before = edges_of(live.roadmap());

  live.update(scene.world, terminals_of(scene), rng);

  EXPECT_EQ(live.work().edges_checked, 0U);
  EXPECT_EQ(edges_of(live.roadmap()), before);
}

TEST(LiveRoadmap, ChecksOnlyEdgesThatAChangeCanAffect) {
  const auto scene = test::standin_scene();
  LiveRoadmapOptions options;
  options.samples = 2000;
  options.connection_radius_m = 10.0;
  Rng rng(2);
  LiveRoadmap live(scene.world, terminals_of(scene), options, rng);
  const std::size_t all = live.work().edges_checked;
  std::vector<Obstacle> obstacles = scene.world.obstacles();
  obstacles.push_back(Circle{{30, 80}, 2.0});

  live.update(with(scene.world, obstacles), terminals_of(scene), rng);

  // Edges that come within r + kσ of the obstacle, in the worst case: a disc of 2 + 10 + 9 m of 20
  // 000 m² free, and a sample drawn for each that was lost, with all its edges.
  EXPECT_GT(live.work().edges_checked, 0U);
  EXPECT_GT(live.work().samples_lost, 0U);
  EXPECT_LT(live.work().edges_checked, all / 10);

  obstacles.back() = Circle{{30, 81}, 2.0};
  live.update(with(scene.world, obstacles), terminals_of(scene), rng);

  EXPECT_LT(live.work().edges_checked, all / 10);
}

TEST(LiveRoadmap, ChecksANewGoalAlone) {
  const auto scene = test::standin_scene();
  Rng rng(3);
  std::vector<Gaussian> terminals = terminals_of(scene);
  LiveRoadmap live(scene.world, terminals, {}, rng);
  terminals.back() = Gaussian::from_parameters({170, 130}, 3, 3, 0);

  live.update(scene.world, terminals, rng);

  std::size_t near = 0;
  for (const Gaussian& node : live.roadmap().nodes) {
    near += (node.mean_m() - terminals.back().mean_m()).norm() <= 20.0 ? 1 : 0;
  }
  EXPECT_GT(live.work().edges_checked, 0U);
  // Its samples, and what other terminals reach it.
  EXPECT_LE(live.work().edges_checked, near + terminals.size());
}

TEST(LiveRoadmap, KeepsItsDensityWhereAnObstacleWandersAndIsGone) {
  const auto scene = test::standin_scene();
  LiveRoadmapOptions options;
  Rng rng(4);
  LiveRoadmap live(scene.world, terminals_of(scene), options, rng);
  const auto around = [&] {
    int count = 0;
    for (const Gaussian& node : live.roadmap().nodes) {
      count += Box{{10, 50}, {45, 110}}.contains(node.mean_m()) ? 1 : 0;
    }
    return count;
  };
  const int before = around();
  ASSERT_GT(before, 20);
  for (int lap = 0; lap < 5; ++lap) {
    for (double y = 60; y <= 100; y += 4) {
      std::vector<Obstacle> obstacles = scene.world.obstacles();
      obstacles.push_back(Circle{{25, y}, 6.0});
      live.update(with(scene.world, obstacles), terminals_of(scene), rng);
    }
  }

  live.update(scene.world, terminals_of(scene), rng);

  // The spread of a Poisson count of `before`, four times, and the packing's excess of 9 %.
  EXPECT_GT(around(), before - 4 * std::sqrt(before));
  EXPECT_LT(around(), 1.09 * before + 4 * std::sqrt(before));
  EXPECT_LT(live.roadmap().nodes.size(), 1.1 * static_cast<double>(options.samples));
}

TEST(LiveRoadmap, FillsAWorldThatOpensUp) {
  const World closed =
      World::make({{0, 0}, {100, 100}},
                  {Polygon::make({{-1, -1}, {70, -1}, {70, 101}, {-1, 101}}).value()})
          .value();
  const World open = World::make({{0, 0}, {100, 100}}, {}).value();
  LiveRoadmapOptions options;
  options.samples = 100;
  Rng rng(5);
  LiveRoadmap live(closed, {}, options, rng);
  ASSERT_EQ(live.roadmap().nodes.size(), 100U);

  live.update(open, {}, rng);

  // 100 samples on 30 % of the area: 333 at the same density.
  EXPECT_GT(live.roadmap().nodes.size(), 240U);
  EXPECT_LT(live.roadmap().nodes.size(), 400U);
  expect_as_from_scratch(live, 0, options);
}

TEST(LiveRoadmap, RepeatsItself) {
  const auto scene = test::standin_scene();
  const auto run = [&] {
    Rng rng(6);
    LiveRoadmap live(scene.world, terminals_of(scene), {}, rng);
    std::vector<Obstacle> obstacles = scene.world.obstacles();
    obstacles.push_back(Circle{{30, 80}, 9.0});
    live.update(with(scene.world, obstacles), terminals_of(scene), rng);
    live.update(scene.world, terminals_of(scene), rng);
    return edges_of(live.roadmap());
  };

  EXPECT_EQ(run(), run());
}

TEST(WorldChange, FindsWhatIsNewAndWhatIsGone) {
  const Circle a{{10, 10}, 1.0};
  const Circle b{{20, 20}, 1.0};
  const Circle c{{30, 30}, 1.0};
  const auto world = [](std::vector<Obstacle> obstacles) {
    return World::make({{0, 0}, {50, 50}}, std::move(obstacles)).value();
  };

  EXPECT_TRUE(world_change(world({a, b, c}), world({c, a, b})).empty());
  EXPECT_TRUE(world_change(world({}), world({})).empty());

  const WorldChange moved = world_change(world({a, b, c}), world({a, Circle{{21, 20}, 1.0}, c}));
  ASSERT_EQ(moved.added.size(), 1U);
  ASSERT_EQ(moved.removed.size(), 1U);
  EXPECT_EQ(moved.added[0].min_m, Vec2(20, 19));
  EXPECT_EQ(moved.removed[0].min_m, Vec2(19, 19));

  // Of two equal obstacles one may go.
  EXPECT_EQ(world_change(world({a, a, b}), world({b, a})).removed.size(), 1U);
  EXPECT_EQ(world_change(world({b, a}), world({a, a, b})).added.size(), 1U);
}

}  // namespace
}  // namespace swarm::planner
