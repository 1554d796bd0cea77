// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/straighten.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "planner_service/flow/plan_density.hpp"
#include "planner_service/methods/shared/route_plan.hpp"
#include "planner_service/plan_checks.hpp"
#include "tests/unit/planner_service/planners.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

constexpr DensityCap kNoCap{.max_per_m2 = 1e6, .robots = 100.0};

Gaussian at(double x, double y, double sigma_m = 1.5) {
  return Gaussian::from_parameters({x, y}, sigma_m, sigma_m, 0.0);
}

// One route through these means, 10 s a leg.
FlowPlan route_of(const std::vector<Vec2>& means_m) {
  std::vector<PlanNode> nodes;
  std::vector<PlanLeg> legs;
  for (std::uint32_t i = 0; i < means_m.size(); ++i) {
    nodes.push_back({at(means_m[i].x(), means_m[i].y()), MissionTime(10.0 * i), 1.0});
    if (i > 0) legs.push_back({i - 1, i, 1.0});
  }
  return FlowPlan::make(std::move(nodes), std::move(legs)).value();
}

std::vector<bool> ends_of(const FlowPlan& plan) {
  std::vector<bool> is_end(plan.nodes().size(), false);
  for (const std::uint32_t i : plan.sources()) is_end[i] = true;
  for (const std::uint32_t i : plan.sinks()) is_end[i] = true;
  return is_end;
}

TEST(Straighten, MakesAZigzagALineAtAnEvenSpeed) {
  const World world = World::make({{-100, -100}, {100, 100}}, {}).value();
  EdgeChecker checker(world, {});
  const FlowPlan zigzag = route_of({{0, 0}, {6, 5}, {20, -4}, {24, 5}, {40, 0}});
  StraightenOptions options{.speed = {10.0}};
  options.sweeps = 200;
  options.worthwhile = 1e-6;

  const FlowPlan line = straighten(zigzag, ends_of(zigzag), world, {}, kNoCap, options, checker);

  EXPECT_NEAR(mean_path_m(line), 40.0, 1e-3);
  // What is straight needs no node in its middle.
  ASSERT_EQ(line.nodes().size(), zigzag.nodes().size());
  for (std::uint32_t i = 0; i < 5; ++i) {
    // A node that would save less than 1e-6 of the action stays.
    EXPECT_NEAR(line.nodes()[i].gaussian.mean_m().x(), 10.0 * i, 0.1);
    EXPECT_EQ(line.nodes()[i].time, zigzag.nodes()[i].time);
  }
}

TEST(Straighten, KeepsTheSpeedOfItsLegs) {
  const World world = World::make({{-100, -100}, {100, 100}}, {}).value();
  EdgeChecker checker(world, {});
  const FlowPlan bent = FlowPlan::make({{at(0, 0), MissionTime(0), 1.0},
                                        {at(6, 8), MissionTime(11), 1.0},
                                        {at(12, 0), MissionTime(22), 1.0}},
                                       {{0, 1, 1.0}, {1, 2, 1.0}})
                            .value();

  const FlowPlan plan =
      straighten(bent, ends_of(bent), world, {}, kNoCap, {.speed = {1.0}}, checker);

  EXPECT_LT(mean_path_m(plan), 12.1);
  for (const PlanLeg& leg : plan.legs()) {
    const PlanNode& from = plan.nodes()[leg.from];
    const PlanNode& to = plan.nodes()[leg.to];
    EXPECT_LE(leg_duration_s(from.gaussian, to.gaussian, 1.0),
              (to.time - from.time).count() + 1e-6);
  }
}

TEST(Straighten, DoesNotMoveRoutesTogetherAboveTheCap) {
  // Two routes that bulge apart between ends that are not dense; in the middle both are narrow.
  const World world = World::make({{-100, -100}, {100, 100}}, {}).value();
  EdgeChecker checker(world, {});
  const FlowPlan bulged = FlowPlan::make({{at(0, -4, 4), MissionTime(0), 0.5},
                                          {at(0, 4, 4), MissionTime(0), 0.5},
                                          {at(20, -9, 1), MissionTime(30), 0.5},
                                          {at(20, 9, 1), MissionTime(30), 0.5},
                                          {at(40, -4, 4), MissionTime(60), 0.5},
                                          {at(40, 4, 4), MissionTime(60), 0.5}},
                                         {{0, 2, 0.5}, {1, 3, 0.5}, {2, 4, 0.5}, {3, 5, 0.5}})
                              .value();
  const DensityCap cap{.max_per_m2 = 1.001 * max_density(bulged, 100.0, 0.5).per_m2,
                       .robots = 100.0};
  // All in the same place at the same time would be twice as dense.
  const FlowPlan plan = straighten(bulged, ends_of(bulged), world, {}, cap, {}, checker);

  EXPECT_LT(mean_path_m(plan), mean_path_m(bulged) - 0.5);
  EXPECT_LE(max_density(plan, 100.0, 0.5).per_m2, cap.max_per_m2);
}

class StraightenedStandin : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  // The plan of 500 robots under a cap, as the flow gave it and pulled straight.
  FlowPlan plan_of(std::uint32_t shortcuts) const {
    Mission mission;
    mission.world = scene_.world;
    mission.robots.count = 500;
    mission.planner.density_cap_per_m2 = kCap_per_m2;
    mission.planner.options.set("shortcuts", shortcuts);
    Rng rng(GetParam());
    mission.start = scene_.start;
    mission.goal = scene_.goal;
    options_ = test::swarmprm_options_of(mission);
    return test::plan_mission(mission, rng).value().plan;
  }

  static constexpr double kCap_per_m2 = 2.0;
  test::StandinScene scene_ = test::standin_scene();
  mutable SwarmPrmOptions options_;
};

INSTANTIATE_TEST_SUITE_P(Seeds, StraightenedStandin, ::testing::Values(1U, 2U, 3U));

TEST_P(StraightenedStandin, IsShorterAndKeepsAllElse) {
  const FlowPlan raw = plan_of(0);
  const FlowPlan plan = plan_of(200);

  EXPECT_LT(mean_path_m(plan), mean_path_m(raw) - 0.025 * test::kStandinMeanBound_m);
  EXPECT_LT(mean_path_m(plan), 1.09 * test::kStandinMeanBound_m);
  // Nodes with their times and masses, in their order; new ones only behind them.
  ASSERT_GE(plan.nodes().size(), raw.nodes().size());
  for (std::size_t i = 0; i < raw.nodes().size(); ++i) {
    EXPECT_EQ(plan.nodes()[i].time, raw.nodes()[i].time);
    EXPECT_EQ(plan.nodes()[i].mass, raw.nodes()[i].mass);
  }
  EXPECT_EQ(plan.sources(), raw.sources());
  EXPECT_EQ(plan.sinks(), raw.sinks());
  EXPECT_EQ(plan.duration(), raw.duration());
  std::vector<const Gaussian*> ends;
  for (const Mixture* mixture : {&scene_.start, &scene_.goal}) {
    for (const WeightedGaussian& c : mixture->components()) ends.push_back(&c.gaussian);
  }
  const auto is_end = [&](const Gaussian& g) {
    return std::any_of(ends.begin(), ends.end(),
                       [&](const Gaussian* end) { return end->mean_m() == g.mean_m(); });
  };
  for (std::size_t i = 0; i < raw.nodes().size(); ++i) {
    EXPECT_EQ(is_end(raw.nodes()[i].gaussian), is_end(plan.nodes()[i].gaussian));
  }
  // Risk by 201 points of every leg, density by the search for its highest peak.
  EXPECT_LE(planned_max_cvar_m(plan, scene_.world, 0.05), -0.2 + 1e-3);
  EXPECT_LE(max_density(plan, 500.0, 0.5).per_m2, kCap_per_m2 + 1e-9);
  for (const PlanLeg& leg : plan.legs()) {
    const PlanNode& from = plan.nodes()[leg.from];
    const PlanNode& to = plan.nodes()[leg.to];
    const double duration_s = (to.time - from.time).count();
    EXPECT_LE((to.gaussian.mean_m() - from.gaussian.mean_m()).norm(),
              options_.speed_mps * duration_s + 1e-6);
    if (!is_end(from.gaussian) && !is_end(to.gaussian)) continue;
    EXPECT_LE(longest_robot_path_m(from.gaussian, to.gaussian),
              options_.limits.robot_speed_mps * duration_s + 1e-6);
  }
}

TEST_P(StraightenedStandin, IsTheSameAgain) {
  EXPECT_EQ(plan_of(200).digest(), plan_of(200).digest());
}

}  // namespace
}  // namespace swarm::planner
