// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/executed_risk.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/unit/swarm_monitor/audit/tracking/planned_run.hpp"

namespace swarm::monitor {
namespace {

TEST(EmpiricalCvar, IsTheLeastOfItsDefinition) {
  // min_z z + 1/α E[(Y − z)⁺] is reached at one of the values.                     [ROVER, eq. 25a]
  Rng rng(21);
  for (int round = 0; round < 50; ++round) {
    std::vector<double> values;
    for (int i = 0; i < 37; ++i) values.push_back(standard_normal(rng));
    const double alpha = uniform(rng, 0.01, 0.6);
    double least = 1e300;
    for (const double z : values) {
      double sum = 0.0;
      for (const double y : values) sum += std::max(0.0, y - z) / 37.0;
      least = std::min(least, z + sum / alpha);
    }

    EXPECT_NEAR(empirical_cvar(values, alpha), least, 1e-12);
  }
}

TEST(EmpiricalCvar, OfAShareBelowOneValueIsTheLargest) {
  std::vector<double> values{1.0, 5.0, 3.0};

  EXPECT_EQ(empirical_cvar(values, 0.05), 5.0);
  EXPECT_EQ(empirical_cvar(values, 1.0 / 3.0), 5.0);
  EXPECT_NEAR(empirical_cvar(values, 0.5), (5.0 + 0.5 * 3.0) / 1.5, 1e-12);
}

TEST(ExecutedRisk, OfASwarmOnItsReferencesIsNearThePlanned) {
  PlannedRun flight;
  flight.robots = 2000;
  flight.end_s = 30.0;
  const RecordedRun run = flight.make();
  const auto moments = PlanTimeline(run).moments(2.0, 30.0, 4.0);

  const auto risk = executed_risk(run, moments);

  ASSERT_TRUE(risk);
  EXPECT_NEAR(risk->filter_m, -0.25, 1e-12);
  // Executed is less: robots stay within the 97 % ellipse, and to a circle the distance grows with
  // the square of the offset along its rim, x²/2r of about 1 m, which the linearised one leaves
  // out.
  EXPECT_LT(risk->worst_m, risk->planned_worst_m);
  EXPECT_GT(risk->worst_m, risk->planned_worst_m - 2.0);
  EXPECT_LT(*risk->most_over_plan_m, 0.1);
  EXPECT_EQ(risk->kept_share, 1.0);
}

TEST(ExecutedRisk, SeesASwarmThatIsPushedAgainstAnObstacle) {
  PlannedRun flight;
  flight.position_m = [&](std::uint32_t i, double tau) -> Vec2 {
    const bool strays = i < 6 && tau > 15.0 && tau < 25.0;
    return strays ? Vec2(40.0 + 0.3 * i, 28.4) : flight.reference_m(i, tau);
  };
  const RecordedRun run = flight.make();
  const auto moments = PlanTimeline(run).moments(2.0, 72.0, 1.0);

  const auto risk = executed_risk(run, moments);

  // The three nearest of 60: 0.1 m and a little more from a circle of 1.5 m around (40, 30).
  ASSERT_TRUE(risk);
  const double expected =
      -((1.6 - 1.5) + (std::hypot(0.3, 1.6) - 1.5) + (std::hypot(0.6, 1.6) - 1.5)) / 3.0;
  EXPECT_NEAR(risk->worst_m, expected, 1e-9);
  EXPECT_GT(*risk->most_over_plan_m, 1.0);
  const auto broken = std::count_if(risk->moments.begin(), risk->moments.end(),
                                    [](const RiskMoment& m) { return m.executed_m > -0.2; });
  EXPECT_EQ(risk->kept_share,
            1.0 - static_cast<double>(broken) / static_cast<double>(risk->moments.size()));
}

TEST(ExecutedRisk, FollowsTheScene) {
  RecordedRun run = PlannedRun{}.make();
  const auto without =
      after(run.scenes.back(), RemoveObstacle{0}, run.mission.world, run.begin + from_seconds(1.0));
  ASSERT_TRUE(without.has_value());
  run.scenes.push_back(*without);
  const auto moments = PlanTimeline(run).moments(2.0, 72.0, 1.0);

  EXPECT_FALSE(executed_risk(run, moments)) << "there is no obstacle";
}

}  // namespace
}  // namespace swarm::monitor
