// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/plan_limits.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "planner_service/flow/plan_density.hpp"
#include "planner_service/plan_checks.hpp"
#include "tests/unit/planner_service/planners.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

Mission standin(std::uint32_t robots) {
  test::StandinScene scene = test::standin_scene();
  Mission mission;
  mission.world = std::move(scene.world);
  mission.start = std::move(scene.start);
  mission.goal = std::move(scene.goal);
  mission.robots.count = robots;
  return mission;
}

Result<PlanResult> plan_of(const Mission& mission, std::uint64_t seed = 1) {
  Rng rng(seed);
  return test::plan_mission(mission, rng);
}

const PlanWarning* warning_of(const PlanResult& result, const std::string& code) {
  const auto found = std::find_if(result.warnings.begin(), result.warnings.end(),
                                  [&](const PlanWarning& w) { return w.code == code; });
  return found == result.warnings.end() ? nullptr : &*found;
}

TEST(PlanLimits, CapTheDensityOnlyWhereRobotsDoNotFit) {
  const auto few = plan_of(standin(100));
  const auto many = plan_of(standin(500));

  ASSERT_TRUE(few.has_value() && many.has_value());
  EXPECT_EQ(few->stats.cap_per_m2, 0.0);
  EXPECT_TRUE(few->warnings.empty());
  EXPECT_NEAR(many->stats.cap_per_m2, 2.05, 0.01);
  EXPECT_LE(max_density(many->plan, 500.0, 0.5).per_m2, many->stats.cap_per_m2 + 1e-9);
  EXPECT_TRUE(many->warnings.empty());
  EXPECT_LE(planned_max_cvar_m(many->plan, standin(500).world, 0.05), -0.2 + 1e-3);
}

TEST(PlanLimits, NameThePositionAndTimeOfADensityThatIsNotCapped) {
  Mission mission = standin(500);
  mission.planner.density_cap_per_m2 = 0.0;
  const auto result = plan_of(mission);
  ASSERT_TRUE(result.has_value());

  // By brute force: robots on a grid of 0.25 m in a disc of 2 m about every metre, every 2 s.
  double densest_per_m2 = 0.0;
  for (double t_s = 0.0; t_s <= result->plan.duration().count(); t_s += 2.0) {
    const Mixture mixture = result->plan.mixture_at(MissionTime(t_s));
    for (const WeightedGaussian& component : mixture.components()) {
      const Vec2 from_m = component.gaussian.mean_m().array().round();
      for (int i = 0; i < 9; ++i) {
        const Vec2 center_m = from_m + Vec2(i % 3 - 1, i / 3 - 1);
        double robots = 0.0;
        int points = 0;
        for (double x = -2.0; x <= 2.0; x += 0.25) {
          for (double y = -2.0; y <= 2.0; y += 0.25) {
            if (x * x + y * y > 4.0) continue;
            robots += 500.0 * mixture.density(center_m + Vec2(x, y));
            ++points;
          }
        }
        densest_per_m2 = std::max(densest_per_m2, robots / points);
      }
    }
  }
  const DensityPeak& densest = result->stats.densest;
  EXPECT_GT(densest_per_m2, 2.73);
  EXPECT_NEAR(densest.per_m2, densest_per_m2, 0.1 * densest_per_m2);

  const PlanWarning* warning = warning_of(*result, "density-infeasible");
  ASSERT_NE(warning, nullptr);
  EXPECT_EQ(warning->text,
            fmt::format("planned density infeasible: {:.1f} robots/m2 at ({:.1f}, {:.1f}) m, t = "
                        "{:.0f} s; at most 2.7 fit",
                        densest.per_m2, densest.at_m.x(), densest.at_m.y(), densest.time.count()));
}

TEST(PlanLimits, LowerTheSpeedOfBodiesWithLagUnlessADensityIsGiven) {
  Mission mission = standin(100);
  mission.robots.model = "unicycle";
  mission.robots.lag_s = declared_lag_s(mission.robots, {.accelerates = true, .turns = true});
  const SwarmLimits limits = swarm_limits(mission.robots, mission.safety, mission.control);
  const auto fastest_mps = [](const FlowPlan& plan) {
    double fastest = 0.0;
    for (const PlanLeg& leg : plan.legs()) {
      const PlanNode& from = plan.nodes()[leg.from];
      const PlanNode& to = plan.nodes()[leg.to];
      const double path_m = (to.gaussian.mean_m() - from.gaussian.mean_m()).norm();
      fastest = std::max(fastest, path_m / (to.time - from.time).count());
    }
    return fastest;
  };

  const auto automatic = plan_of(mission);
  mission.planner.density_cap_per_m2 = 0.0;
  const auto asked = plan_of(mission);

  ASSERT_TRUE(automatic.has_value() && asked.has_value());
  EXPECT_LE(fastest_mps(automatic->plan), limits.plan_speed_mps + 1e-9);
  EXPECT_EQ(warning_of(*automatic, "speed-infeasible"), nullptr);
  EXPECT_GT(fastest_mps(asked->plan), limits.plan_speed_mps);
  EXPECT_NE(warning_of(*asked, "speed-infeasible"), nullptr);
}

TEST(PlanLimits, RaiseTheCapToTheDensityOfStartAndGoal) {
  Mission mission = standin(500);
  mission.goal =
      Mixture::make({{1.0, Gaussian::from_parameters({175, 60}, 5.0, 5.0, 0.0)}}).value();

  const auto result = plan_of(mission);

  ASSERT_TRUE(result.has_value());
  EXPECT_NE(warning_of(*result, "cap-raised"), nullptr);
  EXPECT_GT(result->stats.cap_per_m2, 500.0 / (2.0 * 3.1416 * 25.0));
  EXPECT_LE(max_density(result->plan, 500.0, 0.5).per_m2, result->stats.cap_per_m2 + 1e-9);
}

TEST(PlanLimits, KeepTheUncappedPlanWhereNoneIsFoundUnderACap) {
  Mission mission = standin(5000);
  mission.planner.options.set("samples", 200);
  SwarmPrmOptions options = test::swarmprm_options_of(mission);
  options.limits.cap_per_m2 = 0.01;  // every component is denser by itself, and routes far denser
  Rng rng(1);
  const PlanRequest request{mission.world, mission.start, mission.goal};

  const auto result = test::plan_once(request, options, rng);
  Rng again(1);
  options.cap_is_automatic = false;
  const auto uncapped = test::plan_once(request, options, again);

  ASSERT_TRUE(result.has_value() && uncapped.has_value());
  EXPECT_EQ(result->plan.digest(), uncapped->plan.digest());
  EXPECT_NE(warning_of(*result, "cap-infeasible"), nullptr);
  EXPECT_NE(warning_of(*result, "density-infeasible"), nullptr);
  for (const PlanWarning& warning : result->warnings) {
    EXPECT_EQ(warning.text.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace swarm::planner
