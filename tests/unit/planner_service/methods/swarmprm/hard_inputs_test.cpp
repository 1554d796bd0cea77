// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Extreme and invalid inputs: each gives a clear error or a correct plan, and none hangs.
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "planner_service/plan_checks.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "tests/unit/planner_service/planners.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

using test::standin_scene;
using test::StandinScene;

Result<PlanResult> plan_scene(const StandinScene& scene, const SwarmPrmOptions& options = {}) {
  Rng rng(1);
  return test::plan_once({scene.world, scene.start, scene.goal}, options, rng);
}

Gaussian round(double x, double y, double sigma_m) {
  return Gaussian::from_parameters({x, y}, sigma_m, sigma_m, 0.0);
}

Mixture one(const Gaussian& g) { return Mixture::make({{1.0, g}}).value(); }

World world_of(std::vector<Obstacle> obstacles) {
  return World::make({{0, 0}, {200, 160}}, std::move(obstacles)).value();
}

Polygon block(double x0, double y0, double x1, double y1) {
  return Polygon::make({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}).value();
}

void expect_safe(const Result<PlanResult>& planned, const World& world,
                 const SwarmPrmOptions& options = {}) {
  ASSERT_TRUE(planned.has_value()) << planned.error().message;
  EXPECT_LE(planned_max_cvar_m(planned->plan, world, options.risk.alpha),
            options.risk.delta_m + kPlanTolerance_m);
}

void expect_refusal(const Result<PlanResult>& planned, const std::string& part) {
  ASSERT_FALSE(planned.has_value());
  EXPECT_EQ(planned.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(planned.error().message.find(part), std::string::npos) << planned.error().message;
}

TEST(HardInputs, ObstaclesOverlapTouchAndRepeat) {
  std::vector<Obstacle> obstacles = standin_scene().world.obstacles();
  const std::vector<Obstacle> twice = obstacles;
  obstacles.insert(obstacles.end(), twice.begin(), twice.end());
  for (int i = 0; i < 20; ++i) obstacles.emplace_back(Circle{{100.0 + 0.1 * i, 80}, 12.0});
  StandinScene scene = standin_scene();
  scene.world = world_of(obstacles);

  expect_safe(plan_scene(scene), scene.world);
}

TEST(HardInputs, StartOrGoalInsideAnObstacle) {
  const StandinScene scene = standin_scene();

  expect_refusal(plan_scene({scene.world, one(round(60, 100, 1)), scene.goal}),
                 "start component 0 at (60.0, 100.0) m is too near obstacle 0");
  expect_refusal(plan_scene({scene.world, scene.start, one(round(100, 90, 0.01))}),
                 "goal component 0");
  // On the border, on a corner, and at a circle's very centre, where no direction leads out.
  expect_refusal(plan_scene({scene.world, one(round(50, 100, 1)), scene.goal}), "obstacle 0");
  expect_refusal(plan_scene({scene.world, one(round(50, 80, 1)), scene.goal}), "obstacle 0");
  const World circle = world_of({Circle{{100, 80}, 10}});
  expect_refusal(plan_scene({circle, one(round(100, 80, 1)), one(round(20, 20, 1))}),
                 "start component 0");
}

TEST(HardInputs, GoalThatCannotBeReached) {
  // A closed box around the goal.
  const World world = world_of({block(150, 40, 190, 45), block(150, 95, 190, 100),
                                block(150, 40, 155, 100), block(185, 40, 190, 100)});

  expect_refusal(plan_scene({world, one(round(30, 80, 3)), one(round(170, 70, 3))}), "0 -> 0");
  // Far outside of the bounds of the world: nothing is sampled there, and no obstacle forbids it.
  for (const double away_m : {1e3, 1e8}) {
    const auto outside = plan_scene({world, one(round(30, 80, 3)), one(round(away_m, 0, 3))});
    if (outside) {
      expect_safe(outside, world);
    } else {
      EXPECT_EQ(outside.error().code, ErrorCode::kInfeasible);
    }
  }
}

TEST(HardInputs, WorldThatIsFull) {
  const World world = world_of({block(-10, -10, 99, 170), block(101, -10, 210, 170)});

  // A crevice of 2 m, too narrow for any sample: the route is the straight one, or none.
  const StandinScene scene{world, one(round(100, 20, 0.2)), one(round(100, 140, 0.2))};
  const auto planned = plan_scene(scene);
  if (planned) {
    expect_safe(planned, world);
  } else {
    expect_refusal(planned, "0 -> 0");
  }
}

TEST(HardInputs, InvalidAndTinyWeights) {
  const Gaussian a = round(20, 20, 3);
  const Gaussian b = round(20, 60, 3);

  for (const double weight : {0.0, -0.5, std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity()}) {
    const auto mixture = Mixture::make({{weight, a}, {1.0 - weight, b}});
    ASSERT_FALSE(mixture.has_value());
    EXPECT_EQ(mixture.error().code, ErrorCode::kBadInput);
    EXPECT_NE(mixture.error().message.find("weight"), std::string::npos);
  }

  // A tiny weight is a weight: all mass arrives.
  const StandinScene scene{world_of({}), Mixture::make({{1e-14, a}, {1.0 - 1e-14, b}}).value(),
                           one(round(150, 60, 3))};
  const auto planned = plan_scene(scene);
  ASSERT_TRUE(planned.has_value()) << planned.error().message;
  EXPECT_NEAR(planned->plan.nodes()[planned->plan.sinks()[0]].mass, 1.0, 1e-9);
}

TEST(HardInputs, TinyCovariances) {
  const StandinScene scene = standin_scene();
  const double least = Gaussian::kMinSigma_m;
  // 1 mm wide, 0.3 m from a wall: no sample fits there, but the leg that leaves the start must.
  const StandinScene tiny{scene.world, one(round(49.6, 100, least)), one(round(150.4, 60, least))};

  expect_safe(plan_scene(tiny), scene.world);

  SwarmPrmOptions options;
  options.sampler.sigma_min_m = least;
  options.sampler.sigma_max_m = 2.0 * least;
  expect_safe(plan_scene(tiny, options), scene.world, options);
}

TEST(HardInputs, HugeCovariances) {
  const double most = Gaussian::kMaxSigma_m;
  const Gaussian huge = round(100, 80, most);
  const Gaussian needle = Gaussian::from_parameters({20, 80}, 1000.0, Gaussian::kMinSigma_m, 0.0);

  expect_refusal(plan_scene({standin_scene().world, one(huge), standin_scene().goal}),
                 "start component 0");
  const auto open = plan_scene({world_of({}), one(huge), one(round(100, 80, 1))});
  ASSERT_TRUE(open.has_value()) << open.error().message;
  // Kilometres long and a millimetre wide, along a wall that it may not touch, turning by 90°.
  const World wall = world_of({block(-3000, 0, 3000, 70)});
  const Gaussian turned = Gaussian::from_parameters({150, 120}, 0.5, 0.5, 0.0);
  const auto along = plan_scene({wall, one(needle), one(turned)});
  if (along) {
    expect_safe(along, wall);
  } else {
    EXPECT_EQ(along.error().code, ErrorCode::kInfeasible);
  }
  // A sampler that draws them.
  SwarmPrmOptions options;
  options.sampler.sigma_min_m = 100.0;
  options.sampler.sigma_max_m = most;
  const auto few = plan_scene(standin_scene(), options);
  ASSERT_FALSE(few.has_value());
  EXPECT_EQ(few.error().code, ErrorCode::kInfeasible);
}

TEST(HardInputs, OptionsAtTheirEnds) {
  const StandinScene scene = standin_scene();
  SwarmPrmOptions options;
  options.samples = 0;
  expect_refusal(plan_scene(scene, options), "planner.samples");
  options.samples = 1;
  expect_refusal(plan_scene(scene, options), "planner.samples");

  options = {};
  options.connection_radius_m = 1e-9;
  expect_refusal(plan_scene(scene, options), "planner.connection_radius_m");
  options.samples = 60;
  options.connection_radius_m = 1e9;
  const auto everything = plan_scene(scene, options);
  if (everything) {
    expect_safe(everything, scene.world, options);
  }

  options = {};
  options.risk.delta_m = -1e6;
  expect_refusal(plan_scene(scene, options), "start component 0");
  options.risk.delta_m = 0.0;
  options.risk.alpha = 1.0 - 1e-9;
  expect_safe(plan_scene(scene, options), scene.world, options);
}

TEST(HardInputs, WorldsOfOddSize) {
  // A micrometre wide, a thousand kilometres wide, and a line.
  const World dot = World::make({{0, 0}, {1e-6, 1e-6}}, {}).value();
  const auto in_dot = plan_scene({dot, one(round(0, 0, 1)), one(round(1e-6, 0, 1))});
  EXPECT_TRUE(in_dot.has_value());
  const World vast = World::make({{-5e5, -5e5}, {5e5, 5e5}}, {Circle{{0, 0}, 1e4}}).value();
  const auto in_vast = plan_scene({vast, one(round(-4e5, 0, 3)), one(round(4e5, 0, 3))});
  if (in_vast) {
    expect_safe(in_vast, vast);
  } else {
    expect_refusal(in_vast, "planner.connection_radius_m");
  }
  const World line = World::make({{0, 0}, {1e4, 1e-3}}, {}).value();
  EXPECT_FALSE(plan_scene({line, one(round(0, 0, 1)), one(round(1e4, 0, 1))}).has_value());
}

// The blocks of the stand-in scene, made of circles.
World pebbles(std::size_t count) {
  const World blocks = standin_scene().world;
  const double spacing_m = std::sqrt(10'525.0 / static_cast<double>(count));
  std::vector<Obstacle> obstacles;
  for (double x = 0.5 * spacing_m; x < 200.0; x += spacing_m) {
    for (double y = 0.5 * spacing_m; y < 160.0; y += spacing_m) {
      if (blocks.distance_m({x, y}) < 0.0) obstacles.emplace_back(Circle{{x, y}, 0.7 * spacing_m});
    }
  }
  return world_of(std::move(obstacles));
}

TEST(HardInputs, TenThousandObstacles) {
  StandinScene scene = standin_scene();
  scene.world = pebbles(10'000);
  ASSERT_GT(scene.world.obstacles().size(), 9'500U);
  // A point robot's margin more than the blocks: pebbles stick out by 0.2 spacings.
  SwarmPrmOptions options;
  options.risk.alpha = 0.06;

  const auto planned = plan_scene(scene, options);

  expect_safe(planned, scene.world, options);
  EXPECT_LT(planned->stats.planned_mean_path_m, 1.2 * test::kStandinMeanBound_m);
}

TEST(HardInputs, TenThousandObstaclesEverywhere) {
  Rng rng(1);
  std::vector<Obstacle> obstacles;
  for (int i = 0; i < 10'000; ++i) {
    obstacles.emplace_back(Circle{{uniform(rng, 0, 200), uniform(rng, 0, 160)}, 0.3});
  }
  const World world = world_of(std::move(obstacles));

  expect_refusal(plan_scene({world, standin_scene().start, standin_scene().goal}),
                 "start component 3");
}

}  // namespace
}  // namespace swarm::planner
