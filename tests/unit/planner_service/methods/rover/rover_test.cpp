// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/rover.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "planner_service/methods/rover/measured_state.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarmflow/core/random.hpp"
#include "tests/unit/planner_service/methods/rover/rover_scene.hpp"

namespace swarm::planner {
namespace {

RoverMission planned(const Mission& mission, const RoverOptions& options) {
  Rover rover = Rover::make(mission.world, mission.goal, options).value();
  auto result = rover.plan(mission.start);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  return result ? *std::move(result) : RoverMission{};
}

double mean_path_m(const FlowPlan& plan) {
  double sum_m = 0.0;
  for (const PlanLeg& leg : plan.legs()) {
    sum_m +=
        leg.mass *
        (plan.nodes()[leg.to].gaussian.mean_m() - plan.nodes()[leg.from].gaussian.mean_m()).norm();
  }
  return sum_m;
}

class RoverMissions : public ::testing::TestWithParam<int> {};

TEST_P(RoverMissions, KeepTheirRiskAtEveryStepAndHalfway) {
  const Mission mission = test::rover_scene(GetParam());
  const RoverOptions options;
  const RiskLimit& risk = options.graph.risk;

  const FlowPlan plan = planned(mission, options).plan;

  // The nodes' times are those of the steps.
  std::vector<double> times_s;
  for (const PlanNode& node : plan.nodes()) times_s.push_back(node.time.count());
  std::sort(times_s.begin(), times_s.end());
  times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
  ASSERT_GT(times_s.size(), 5U);
  double tightest_m = -1e9;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const auto cvar_m = [&](double time_s) {
      return max_mixture_cvar_m(plan.mixture_at(MissionTime(time_s)), mission.world, risk.alpha);
    };
    EXPECT_LE(cvar_m(times_s[i]), risk.delta_m) << times_s[i];
    if (i > 0) {
      EXPECT_LE(cvar_m(0.5 * (times_s[i - 1] + times_s[i])), risk.delta_m) << times_s[i];
    }
    tightest_m = std::max(tightest_m, cvar_m(times_s[i]));
  }
  // Risk is used where it shortens paths: somewhere the promise is just kept.
  EXPECT_GT(tightest_m, risk.delta_m - 0.01);
}

TEST_P(RoverMissions, JoinTheStartWithTheGoalInOrder) {
  const Mission mission = test::rover_scene(GetParam());
  const RoverOptions options;

  const FlowPlan plan = planned(mission, options).plan;

  const auto matches = [&](const std::vector<std::uint32_t>& nodes, const Mixture& mixture) {
    ASSERT_EQ(nodes.size(), mixture.components().size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const PlanNode& node = plan.nodes()[nodes[i]];
      const WeightedGaussian& component = mixture.components()[i];
      EXPECT_LT(wasserstein2(node.gaussian, component.gaussian), 1e-6);
      EXPECT_NEAR(node.mass, component.weight, 1e-5);
    }
  };
  matches(plan.sources(), mission.start);
  matches(plan.sinks(), mission.goal);
  for (const PlanLeg& leg : plan.legs()) {
    const PlanNode& from = plan.nodes()[leg.from];
    const PlanNode& to = plan.nodes()[leg.to];
    EXPECT_TRUE(mission.world.segment_is_free(from.gaussian.mean_m(), to.gaussian.mean_m(), 0.99));
    EXPECT_LE(wasserstein2(from.gaussian, to.gaussian),
              options.speed_mps * (to.time - from.time).count() + 1e-6);
  }
}

TEST_P(RoverMissions, EveryProgramIsSolvedToItsOptimum) {
  const Mission mission = test::rover_scene(GetParam());
  RoverOptions options;
  options.mpc.keep_program = true;

  const RoverMission result = planned(mission, options);

  for (std::size_t k = 0; k < result.steps.size(); k += 4) {
    // The program with all columns at once, by the other simplex, from nothing.
    const HorizonPlan& horizon = result.steps[k].horizon;
    LpBasis basis = slack_basis(horizon.program);
    const LpSolution solution = solve(horizon.program, basis, LpMethod::kPrimalSimplex);
    ASSERT_EQ(solution.status, LpStatus::kOptimal);
    EXPECT_NEAR(solution.objective, horizon.optimum, 1e-6 * (1.0 + horizon.optimum)) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenarios, RoverMissions, ::testing::Values(1, 2, 3));

TEST(Rover, CostNeverRisesFromStepToStep) {
  // The plan of a step, then waiting, is a plan for the next: as good at least.
  const RoverMission mission = planned(test::rover_scene(2), {});
  for (std::size_t k = 1; k < mission.steps.size(); ++k) {
    EXPECT_LT(mission.steps[k].horizon.cost_m2, mission.steps[k - 1].horizon.cost_m2) << k;
  }
}

TEST(Rover, MoreRiskIsAShorterPath) {
  const Mission mission = test::rover_scene(2);
  double last_m = 1e9;
  for (const double alpha : {0.05, 0.15, 0.3}) {
    RoverOptions options;
    options.graph.risk.alpha = alpha;
    const double path_m = mean_path_m(planned(mission, options).plan);
    EXPECT_LT(path_m, last_m) << alpha;
    last_m = path_m;
  }
}

TEST(Rover, RepeatsItself) {
  const Mission mission = test::rover_scene(3);
  EXPECT_EQ(planned(mission, {}).plan.digest(), planned(mission, {}).plan.digest());
}

TEST(Rover, KeepsTheDensityCap) {
  const Mission mission = test::rover_scene(2);
  RoverOptions options;
  options.mpc.robots = 100.0;
  const auto densest = [&](const FlowPlan& plan) {
    double highest = 0.0;
    for (const PlanNode& node : plan.nodes()) {
      if (node.time.count() == 0.0) continue;
      const Mixture mixture = plan.mixture_at(node.time);
      for (const WeightedGaussian& c : mixture.components()) {
        highest = std::max(highest, 100.0 * mixture.density(c.gaussian.mean_m()));
      }
    }
    return highest;
  };
  const double uncapped = densest(planned(mission, options).plan);

  options.mpc.density_cap_per_m2 = 0.8 * uncapped;
  const double capped = densest(planned(mission, options).plan);

  EXPECT_LE(capped, 0.8 * uncapped * (1.0 + 1e-6));
}

TEST(Rover, ContinuesFromTheRobotPositions) {
  const Mission mission = test::rover_scene(1);
  RoverOptions options;
  options.mpc.soften = true;  // what is measured may break the limit
  Rover rover = Rover::make(mission.world, mission.goal, options).value();
  Mixture current = mission.start;
  for (int k = 0; k < 3; ++k) current = rover.step(current).value().to;
  Rng rng(1);
  std::vector<Vec2> robots;
  while (robots.size() < 100) {
    const Gaussian& g = current.components()[current.component_at(uniform01(rng))].gaussian;
    const double x = standard_normal(rng);
    const Vec2 robot_m =
        g.mean_m() + cholesky_lower(g.covariance_m2()) * Vec2(x, standard_normal(rng));
    if (mission.world.is_clear(robot_m, 0.2)) robots.push_back(robot_m);
  }

  const auto step = rover.step(measured_mixture(rover.graph(), robots));

  ASSERT_TRUE(step.has_value()) << step.error().message;
  EXPECT_GT(step->duration_s, 0.0);
  double before_m = 0.0, after_m = 0.0;
  for (const auto& [weight, g] : step->from.components()) before_m += weight * g.mean_m().x();
  for (const auto& [weight, g] : step->to.components()) after_m += weight * g.mean_m().x();
  EXPECT_GT(after_m, before_m + 5.0) << "towards the goal";
  double arcs = 0.0;
  for (const RoverStep::Arc& arc : step->arcs) arcs += arc.mass;
  EXPECT_NEAR(arcs, 1.0, 1e-9);
}

TEST(Rover, ReportsWhatToLoosen) {
  const auto box = [](double y0, double y1) {
    return Obstacle(Polygon::make({{95, y0}, {105, y0}, {105, y1}, {95, y1}}).value());
  };
  const World closed = World::make({{0, 0}, {200, 160}}, {box(0, 160)}).value();
  const World beside = World::make({{0, 0}, {200, 160}}, {box(60, 100)}).value();
  const auto at = [](double x, double y) {
    return Mixture::make({{1.0, Gaussian::from_parameters({x, y}, 7.0, 7.0, 0.0)}}).value();
  };
  const auto message = [](const World& world, const Mixture& start, const Mixture& goal) {
    auto rover = Rover::make(world, goal, {});
    if (!rover) return rover.error().message;
    const auto mission = rover->plan(start);
    EXPECT_FALSE(mission.has_value());
    if (mission) return std::string();
    EXPECT_EQ(mission.error().code, ErrorCode::kInfeasible);
    return mission.error().message;
  };

  EXPECT_NE(message(closed, at(50, 80), at(150, 80)).find("no path to any goal"),
            std::string::npos);
  const std::string start = message(beside, at(90, 80), at(150, 20));
  EXPECT_NE(start.find("start: CVaR"), std::string::npos) << start;
  EXPECT_NE(start.find("obstacle 0"), std::string::npos) << start;
  const std::string goal = message(beside, at(50, 20), at(110, 80));
  EXPECT_NE(goal.find("goal: CVaR"), std::string::npos) << goal;
  EXPECT_NE(goal.find("raise epsilon to"), std::string::npos) << goal;
}

TEST(Rover, AStepThatCannotKeepTheLimitReportsByHowMuch) {
  // All of the swarm 3 m from a wall: it cannot get away within a step.
  const World world =
      World::make({{0, 0}, {200, 160}},
                  {Polygon::make({{95, 60}, {105, 60}, {105, 100}, {95, 100}}).value()})
          .value();
  const auto at = [](double x, double y) {
    return Mixture::make({{1.0, Gaussian::from_parameters({x, y}, 7.0, 7.0, 0.0)}}).value();
  };
  RoverOptions options;
  options.graph.transport_radius_m = 11.0;
  Rover strict = Rover::make(world, at(150, 20), options).value();
  options.mpc.soften = true;
  Rover soft = Rover::make(world, at(150, 20), options).value();

  const auto refused = strict.step(at(92, 80));
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kInfeasible);
  for (const char* part : {"CVaR", "obstacle 0", "step 1", "raise epsilon to", "alpha from 0.05"}) {
    EXPECT_NE(refused.error().message.find(part), std::string::npos) << refused.error().message;
  }
  const auto softened = soft.step(at(92, 80));
  ASSERT_TRUE(softened.has_value());
  EXPECT_GT(softened->horizon.excess, 0.0);
  EXPECT_LT(softened->cvar_m[1], max_mixture_cvar_m(at(92, 80), world, 0.05)) << "away from it";
  const auto mission = soft.plan(at(92, 80));
  ASSERT_TRUE(mission.has_value()) << mission.error().message;
  EXPECT_EQ(mission->steps.back().horizon.excess, 0.0);
}

TEST(Rover, WithoutObstaclesThereIsNoRisk) {
  const World world = World::make({{0, 0}, {200, 160}}, {}).value();
  const Mission scene = test::rover_scene(1);
  Rover rover = Rover::make(world, scene.goal, {}).value();

  const auto mission = rover.plan(scene.start);

  ASSERT_TRUE(mission.has_value()) << mission.error().message;
  for (const RoverStep& step : mission->steps) EXPECT_EQ(step.horizon.iterations, 1);
  // 152.4 m straight from start to goal means; paths on the grid are at most 2.7 % longer but for
  // the first and last leg, which join a component that is not on the grid.
  EXPECT_LT(mean_path_m(mission->plan), 1.05 * 152.4);
}

TEST(Rover, RefusesBadOptions) {
  const Mission mission = test::rover_scene(1);
  RoverOptions options;
  options.mpc.costs.horizon = 0;
  EXPECT_EQ(Rover::make(mission.world, mission.goal, options).error().code, ErrorCode::kBadInput);
  options = {};
  options.speed_mps = -1.0;
  EXPECT_EQ(Rover::make(mission.world, mission.goal, options).error().code, ErrorCode::kBadInput);
  options = {};
  options.mpc.robots = 1000.0;
  options.mpc.density_cap_per_m2 = 0.01;
  EXPECT_EQ(Rover::make(mission.world, mission.goal, options).error().code, ErrorCode::kInfeasible);
}

}  // namespace
}  // namespace swarm::planner
