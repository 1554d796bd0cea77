// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "planner_service/plan_checks.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "tests/unit/planner_service/planners.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

using test::standin_scene;
using test::StandinScene;

Result<PlanResult> plan_scene(const StandinScene& scene, const SwarmPrmOptions& options,
                              std::uint64_t seed) {
  Rng rng(seed);
  return test::plan_once({scene.world, scene.start, scene.goal}, options, rng);
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Planner, FindsShortSafePlansOnThirtySeeds) {
  const StandinScene scene = standin_scene();
  for (const std::uint32_t shortcuts : {0U, 200U}) {
    SwarmPrmOptions options;
    options.shortcuts = shortcuts;
    double ratio_sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      const auto planned = plan_scene(scene, options, seed);

      ASSERT_TRUE(planned.has_value()) << "seed " << seed << ": " << planned.error().message;
      const double ratio = planned->stats.planned_mean_path_m / test::kStandinMeanBound_m;
      EXPECT_GT(ratio, 1.0);  // nothing beats the bound
      ratio_sum += ratio;
      EXPECT_LE(planned_max_cvar_m(planned->plan, scene.world, options.risk.alpha),
                options.risk.delta_m + kPlanTolerance_m);
    }
    // What the runtime promises of its planner on this scene.
    EXPECT_LE(ratio_sum / 30.0, shortcuts == 0 ? 1.15 : 1.10);
  }
}

TEST(Planner, PlansStartAndEndAtTheMixturesOfTheMission) {
  const StandinScene scene = standin_scene();

  const auto planned = plan_scene(scene, {}, 3);

  ASSERT_TRUE(planned.has_value());
  const FlowPlan& flow = planned->plan;
  const auto& starts = scene.start.components();
  const auto& goals = scene.goal.components();
  ASSERT_EQ(flow.sources().size(), starts.size());
  ASSERT_EQ(flow.sinks().size(), goals.size());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const PlanNode& node = flow.nodes()[flow.sources()[i]];
    EXPECT_EQ(node.gaussian.mean_m(), starts[i].gaussian.mean_m());
    EXPECT_EQ(node.gaussian.covariance_m2(), starts[i].gaussian.covariance_m2());
    EXPECT_NEAR(node.mass, starts[i].weight, 1e-9);
    EXPECT_EQ(node.time, MissionTime(0));
  }
  for (std::size_t j = 0; j < goals.size(); ++j) {
    const PlanNode& node = flow.nodes()[flow.sinks()[j]];
    EXPECT_EQ(node.gaussian.mean_m(), goals[j].gaussian.mean_m());
    EXPECT_NEAR(node.mass, goals[j].weight, 1e-9);
  }
}

TEST(Planner, NoMeanIsFasterThanAsked) {
  const StandinScene scene = standin_scene();
  SwarmPrmOptions options;
  options.speed_mps = 0.8;

  const auto planned = plan_scene(scene, options, 4);

  ASSERT_TRUE(planned.has_value());
  for (const PlanLeg& leg : planned->plan.legs()) {
    const PlanNode& from = planned->plan.nodes()[leg.from];
    const PlanNode& to = planned->plan.nodes()[leg.to];
    const double path_m = (to.gaussian.mean_m() - from.gaussian.mean_m()).norm();
    EXPECT_LE(path_m, 0.8 * (to.time - from.time).count() + 1e-9);
  }
}

TEST(Planner, StatsDescribeThePlan) {
  const StandinScene scene = standin_scene();

  const auto planned = plan_scene(scene, {}, 5);

  ASSERT_TRUE(planned.has_value());
  double mean_path_m = 0.0;
  double cost_m = 0.0;
  for (const PlanLeg& leg : planned->plan.legs()) {
    const Gaussian& from = planned->plan.nodes()[leg.from].gaussian;
    const Gaussian& to = planned->plan.nodes()[leg.to].gaussian;
    mean_path_m += leg.mass * (to.mean_m() - from.mean_m()).norm();
    cost_m += leg.mass * wasserstein2(from, to);
  }
  EXPECT_NEAR(planned->stats.planned_mean_path_m, mean_path_m, 1e-9);
  EXPECT_NEAR(planned->stats.cost_m, cost_m, 1e-9);
  EXPECT_EQ(planned->stats.nodes, 507U);
  EXPECT_EQ(planned->stats.edges, planned->roadmap.edge_count());
}

TEST(Planner, TakesTheTimeOfItsStagesFromTheClock) {
  const StandinScene scene = standin_scene();
  int calls = 0;
  Rng rng(1);

  const auto planned = test::plan_once({scene.world, scene.start, scene.goal}, {}, rng, [&] {
    return SteadyTime(std::chrono::milliseconds(10 * calls++));
  });

  ASSERT_TRUE(planned.has_value());
  const PlanStats& s = planned->stats;
  EXPECT_DOUBLE_EQ(s.roadmap_ms, 10.0);
  // Two looks at the clock belong to the whole, the first and the last.
  EXPECT_DOUBLE_EQ(s.total_ms, s.roadmap_ms + s.search_ms + s.transport_ms + s.smoothing_ms + 20.0);
}

TEST(Planner, RepeatsItselfForTheSameSeedOnly) {
  const StandinScene scene = standin_scene();
  std::set<std::uint64_t> digests;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto first = plan_scene(scene, {}, seed);
    const auto second = plan_scene(scene, {}, seed);

    ASSERT_TRUE(first.has_value() && second.has_value());
    EXPECT_EQ(first->plan.digest(), second->plan.digest());
    digests.insert(first->plan.digest());
  }
  EXPECT_EQ(digests.size(), 5U);
}

// Mean over ten seeds of the planned mean path.
double mean_path_m(const StandinScene& scene, const SwarmPrmOptions& options) {
  double sum_m = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto planned = plan_scene(scene, options, seed);
    EXPECT_TRUE(planned.has_value()) << planned.error().message;
    if (planned) sum_m += planned->stats.planned_mean_path_m;
  }
  return sum_m / 10.0;
}

TEST(Planner, TakesShorterPathsTheMoreRiskItMayTake) {
  const StandinScene scene = standin_scene();
  SwarmPrmOptions options;
  double previous_m = 1e9;
  for (const double alpha : {0.03, 0.05, 0.15, 0.3, 0.5}) {
    options.risk.alpha = alpha;
    const double path_m = mean_path_m(scene, options);

    EXPECT_LT(path_m, previous_m) << "alpha " << alpha;
    previous_m = path_m;
  }
}

TEST(Planner, ShowsFewerRobotsInObstaclesTheLessRiskItMayTake) {
  const StandinScene scene = standin_scene();
  SwarmPrmOptions options;
  double before = 0.0;
  for (const double alpha : {0.05, 0.15, 0.3}) {
    options.risk.alpha = alpha;
    const auto planned = plan_scene(scene, options, 1);
    ASSERT_TRUE(planned);
    Rng rng(1);

    const double share = planned_obstacle_share(planned->plan, scene.world, 1'000'000, rng);

    EXPECT_GT(share, before) << "alpha " << alpha;
    EXPECT_LT(share, alpha);  // their mean is 0.2 m outside
    before = share;
  }
}

TEST(Planner, TakesLongerPathsTheMoreClearanceItMustKeep) {
  const StandinScene scene = standin_scene();
  SwarmPrmOptions options;
  double previous_m = 0.0;
  for (const double delta_m : {0.0, -0.5, -1.0, -2.0}) {
    options.risk.delta_m = delta_m;
    const double path_m = mean_path_m(scene, options);

    EXPECT_GT(path_m, previous_m) << "delta " << delta_m;
    previous_m = path_m;
  }
}

TEST(Planner, SmoothsAnEmptyWorldToStraightLines) {
  const Gaussian from = Gaussian::from_parameters({20, 20}, 3, 3, 0);
  const Gaussian to = Gaussian::from_parameters({80, 60}, 2, 4, 0.3);
  const StandinScene scene{World::make({{0, 0}, {100, 100}}, {}).value(),
                           Mixture::make({{1.0, from}}).value(),
                           Mixture::make({{1.0, to}}).value()};

  const auto planned = plan_scene(scene, {}, 1);

  ASSERT_TRUE(planned.has_value()) << planned.error().message;
  EXPECT_EQ(planned->plan.nodes().size(), 2U);
  EXPECT_NEAR(planned->stats.cost_m, wasserstein2(from, to), 1e-9);
}

TEST(Planner, PlansForASwarmThatIsAlreadyThere) {
  const StandinScene scene = standin_scene();
  const StandinScene stay{scene.world, scene.start, scene.start};

  const auto planned = plan_scene(stay, {}, 1);

  ASSERT_TRUE(planned.has_value()) << planned.error().message;
  // W₂ of a Gaussian to itself is the root of a cancelled difference, 3e-7 m.
  EXPECT_NEAR(planned->stats.cost_m, 0.0, 1e-5);
  EXPECT_EQ(planned->plan.legs().size(), 4U);
}

TEST(Planner, ReportsWhichComponentBreaksTheLimitAndWhere) {
  const StandinScene scene = standin_scene();
  SwarmPrmOptions options;
  options.risk.alpha = 0.01;

  const auto planned = plan_scene(scene, options, 1);

  ASSERT_FALSE(planned.has_value());
  EXPECT_EQ(planned.error().code, ErrorCode::kInfeasible);
  EXPECT_TRUE(mentions(planned.error().message, "start component 0")) << planned.error().message;
  EXPECT_TRUE(mentions(planned.error().message, "obstacle 2")) << planned.error().message;
}

TEST(Planner, ReportsWhichComponentsNoRouteJoins) {
  // A wall right across, with a gap too narrow for any sample.
  const auto wall = [](double y0, double y1) {
    return Polygon::make({{45, y0}, {55, y0}, {55, y1}, {45, y1}}).value();
  };
  const auto at = [](double x, double y) { return Gaussian::from_parameters({x, y}, 3, 3, 0); };
  const StandinScene scene{
      World::make({{0, 0}, {100, 100}}, {wall(-10, 49), wall(51, 110)}).value(),
      Mixture::make({{0.5, at(20, 20)}, {0.5, at(20, 80)}}).value(),
      Mixture::make({{0.5, at(25, 50)}, {0.5, at(80, 50)}}).value()};

  const auto planned = plan_scene(scene, {}, 1);

  ASSERT_FALSE(planned.has_value());
  const std::string& message = planned.error().message;
  EXPECT_EQ(planned.error().code, ErrorCode::kInfeasible);
  EXPECT_TRUE(mentions(message, "0 -> 1")) << message;
  EXPECT_TRUE(mentions(message, "1 -> 1")) << message;
  EXPECT_FALSE(mentions(message, "0 -> 0")) << message;
  EXPECT_TRUE(mentions(message, "planner.samples")) << message;
}

TEST(Planner, OptionsComeFromTheMission) {
  Mission mission;
  PlannerSpec& spec = mission.planner;
  spec.options.set("samples", 7);
  spec.options.set("connection_radius_m", 8.0);
  spec.risk_alpha = 0.09;
  spec.risk_delta_m = -1.0;
  spec.options.set("sigma_min_m", 1.1);
  spec.options.set("sigma_max_m", 1.2);
  spec.options.set("rho_max", 0.13);
  spec.options.set("bridge_share", 0.14);
  spec.options.set("bridge_sigma_m", 1.5);
  spec.options.set("shortcuts", 16);
  spec.speed_mps = 0.7;

  const SwarmPrmOptions options = test::swarmprm_options_of(mission);

  EXPECT_EQ(options.samples, 7U);
  EXPECT_EQ(options.connection_radius_m, 8.0);
  EXPECT_EQ(options.risk.alpha, 0.09);
  EXPECT_EQ(options.risk.delta_m, -1.0);
  EXPECT_EQ(options.sampler.sigma_min_m, 1.1);
  EXPECT_EQ(options.sampler.sigma_max_m, 1.2);
  EXPECT_EQ(options.sampler.rho_max, 0.13);
  EXPECT_EQ(options.sampler.bridge_share, 0.14);
  EXPECT_EQ(options.sampler.bridge_sigma_m, 1.5);
  EXPECT_EQ(options.shortcuts, 16U);
  EXPECT_EQ(options.speed_mps, 0.7);
}

}  // namespace
}  // namespace swarm::planner
