// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/plan_density.hpp"

#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

Gaussian at(double x, double y, double sigma_m = 1.0) {
  return Gaussian::from_parameters({x, y}, sigma_m, sigma_m, 0.0);
}

// Routes of two legs that cross in a small square, at random times.
FlowPlan random_plan(Rng& rng) {
  std::vector<PlanNode> nodes;
  std::vector<PlanLeg> legs;
  constexpr std::uint32_t kRoutes = 6;
  for (std::uint32_t r = 0; r < kRoutes; ++r) {
    double time_s = 0.0;
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Vec2 mean_m(uniform(rng, 0.0, 10.0), uniform(rng, 0.0, 10.0));
      const double sigma_m = uniform(rng, 0.7, 2.5);
      nodes.push_back({Gaussian::from_parameters(mean_m, sigma_m, uniform(rng, 0.7, 2.5), 0.4),
                       MissionTime(time_s), 1.0 / kRoutes});
      time_s += uniform(rng, 2.0, 6.0);
      if (i > 0) legs.push_back({3 * r + i - 1, 3 * r + i, 1.0 / kRoutes});
    }
  }
  return FlowPlan::make(nodes, legs).value();
}

TEST(PlanDensity, FindsTheHighestPointOfAFineGrid) {
  constexpr double kStep_s = 0.5;
  Rng rng(1);
  for (int round = 0; round < 10; ++round) {
    const FlowPlan plan = random_plan(rng);
    std::vector<MissionTime> times;
    for (const PlanNode& node : plan.nodes()) times.push_back(node.time);
    for (int i = 0; i * kStep_s <= plan.duration().count(); ++i) times.emplace_back(i * kStep_s);
    double highest = 0.0;
    for (const MissionTime t : times) {
      const Mixture mixture = plan.mixture_at(t);
      for (double x = -1.0; x <= 11.0; x += 0.1) {
        for (double y = -1.0; y <= 11.0; y += 0.1) {
          highest = std::max(highest, 100.0 * mixture.density({x, y}));
        }
      }
    }

    const DensityPeak peak = max_density(plan, 100.0, kStep_s);

    EXPECT_GE(peak.per_m2, highest);
    // A grid point lies within 0.071 m of the top, where a Gaussian of 0.7 m has lost 0.6 %.
    EXPECT_LE(peak.per_m2, 1.006 * highest);
    EXPECT_NEAR(peak.per_m2, 100.0 * plan.mixture_at(peak.time).density(peak.at_m), 1e-9);
  }
}

TEST(PlanDensity, SeesTheMiddleWhereTwoGaussiansMerge) {
  // Half of the swarm each, one standard deviation apart: highest between the means.
  const auto plan = FlowPlan::make({{at(-0.5, 0), MissionTime(0), 0.5},
                                    {at(0.5, 0), MissionTime(0), 0.5},
                                    {at(-0.5, 9), MissionTime(4), 0.5},
                                    {at(0.5, 9), MissionTime(4), 0.5}},
                                   {{0, 2, 0.5}, {1, 3, 0.5}})
                        .value();

  const DensityPeak peak = max_density(plan, 10.0, 1.0);

  EXPECT_NEAR(peak.per_m2, 10.0 * std::exp(-0.125) / (2.0 * std::numbers::pi), 1e-6);
  EXPECT_NEAR(peak.at_m.x(), 0.0, 1e-2);
}

TEST(PlanDensity, FindsTheDensestDiscOfAGrid) {
  constexpr double kStep_s = 1.0;
  constexpr double kRadius_m = 2.0;
  Rng rng(3);
  for (int round = 0; round < 5; ++round) {
    const FlowPlan plan = random_plan(rng);
    const auto disc = [&](const Mixture& mixture, const Vec2& center_m) {
      double sum = 0.0;
      int points = 0;
      for (double x = -kRadius_m; x <= kRadius_m; x += 0.2) {
        for (double y = -kRadius_m; y <= kRadius_m; y += 0.2) {
          if (x * x + y * y > kRadius_m * kRadius_m) continue;
          sum += 100.0 * mixture.density(center_m + Vec2(x, y));
          ++points;
        }
      }
      return sum / points;
    };
    std::vector<MissionTime> times;
    for (const PlanNode& node : plan.nodes()) times.push_back(node.time);
    for (int i = 0; i * kStep_s <= plan.duration().count(); ++i) times.emplace_back(i * kStep_s);
    double highest = 0.0;
    for (const MissionTime t : times) {
      const Mixture mixture = plan.mixture_at(t);
      for (double x = 0.0; x <= 10.0; x += 0.5) {
        for (double y = 0.0; y <= 10.0; y += 0.5) {
          highest = std::max(highest, disc(mixture, {x, y}));
        }
      }
    }

    const DensityPeak densest = densest_disc(plan, 100.0, kRadius_m, kStep_s);

    // Discs on the grid are up to 0.35 m beside the densest one, and have 300 points of it; the
    // search looks at the tops of a density that is smoothed a little differently.
    EXPECT_NEAR(densest.per_m2, highest, 0.03 * highest);
    EXPECT_NEAR(densest.per_m2, disc(plan.mixture_at(densest.time), densest.at_m),
                0.01 * densest.per_m2);
  }
}

TEST(PlanDensity, CountsRobotsInADiscAndNotAtAPoint) {
  // All robots in a Gaussian of 1 m: 1 − e^(−2) of them are within 2 m.
  const auto plan =
      FlowPlan::make({{at(0, 0), MissionTime(0), 1.0}, {at(9, 0), MissionTime(4), 1.0}},
                     {{0, 1, 1.0}})
          .value();

  const double per_m2 = densest_disc(plan, 100.0, 2.0, 1.0).per_m2;

  EXPECT_NEAR(per_m2, 100.0 * (1.0 - std::exp(-2.0)) / (4.0 * std::numbers::pi), 1e-3 * per_m2);
}

TEST(PlanDensity, SharesOfAPeakAddUpToIt) {
  Rng rng(2);
  const FlowPlan plan = random_plan(rng);

  const auto peaks = peaks_above(plan, 100.0, 0.5, 2.0);

  ASSERT_FALSE(peaks.empty());
  double highest = 0.0;
  for (const SharedPeak& shared : peaks) {
    double sum = 0.0;
    for (const DensityShare& share : shared.shares) sum += share.per_m2;
    EXPECT_GT(shared.peak.per_m2, 2.0);
    EXPECT_NEAR(sum, shared.peak.per_m2, 1e-5);  // what adds less than 1e-6 of its peak is left out
    highest = std::max(highest, shared.peak.per_m2);
  }
  // Climbs from different means end within 1 mm of the same top.
  EXPECT_NEAR(highest, max_density(plan, 100.0, 0.5).per_m2, 1e-5);
  EXPECT_TRUE(peaks_above(plan, 100.0, 0.5, highest + 1e-5).empty());
}

TEST(PlanDensity, CountsMassAtRestBeforeAndAfter) {
  const auto plan =
      FlowPlan::make({{at(0, 0, 0.5), MissionTime(3), 1.0}, {at(9, 0, 2.0), MissionTime(8), 1.0}},
                     {{0, 1, 1.0}})
          .value();

  const DensityPeak peak = max_density(plan, 1.0, 0.5);

  EXPECT_NEAR(peak.per_m2, 1.0 / (2.0 * std::numbers::pi * 0.25), 1e-9);
  EXPECT_LE(peak.time.count(), 3.0);
}

}  // namespace
}  // namespace swarm::planner
