// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/plan/flow_draw.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

std::size_t draw(const std::vector<double>& masses, double& share) {
  return draw_by_share(
      masses.size(), [&](std::size_t i) { return masses[i]; }, share);
}

std::vector<double> random_masses(Rng& rng) {
  std::vector<double> masses(rng() % 6 + 1);
  for (double& m : masses) m = uniform(rng, 0.01, 1.0);
  return masses;
}

//   0 ──0.3──▶ 2 ──0.6──▶ 3      sources 0 (mass 0.3) and 1 (0.7), sinks 3 and 4
//   1 ──0.7──▶ 2 ──0.4──▶ 4      times: 0, 0, 4, 10, 20 s
FlowPlan crossing() {
  const auto node = [](double x, double time_s, double mass) {
    return PlanNode{Gaussian::from_parameters({x, 0}, 1, 1, 0), MissionTime(time_s), mass};
  };
  return FlowPlan::make({node(0, 0, 0.3), node(1, 0, 0.7), node(5, 4, 1.0), node(9, 10, 0.6),
                         node(9, 20, 0.4)},
                        {{0, 2, 0.3}, {1, 2, 0.7}, {2, 3, 0.6}, {2, 4, 0.4}})
      .value();
}

TEST(DrawByShare, ChoosesTheIntervalThatHoldsTheShare) {
  Rng rng(1);
  for (int round = 0; round < 500; ++round) {
    const std::vector<double> masses = random_masses(rng);
    const double total = std::accumulate(masses.begin(), masses.end(), 0.0);
    const double before = uniform01(rng);
    double share = before;

    const std::size_t chosen = draw(masses, share);

    ASSERT_LT(chosen, masses.size());
    const double begin =
        std::accumulate(masses.begin(), masses.begin() + static_cast<int>(chosen), 0.0);
    EXPECT_GE(before * total, begin - 1e-12);
    EXPECT_LT(before * total, begin + masses[chosen] + 1e-12);
    // The share is rescaled to the interval.
    EXPECT_NEAR(share, (before * total - begin) / masses[chosen], 1e-9);
  }
}

TEST(DrawByShare, KeepsTheShareBelowOneAndTheChoiceInRange) {
  const double largest = std::nextafter(1.0, 0.0);
  Rng rng(2);
  for (int round = 0; round < 500; ++round) {
    const std::vector<double> masses = random_masses(rng);
    for (const double begin : {0.0, largest}) {
      double share = begin;
      const std::size_t chosen = draw(masses, share);
      EXPECT_EQ(chosen, begin == 0.0 ? 0 : masses.size() - 1);
      EXPECT_GE(share, 0.0);
      EXPECT_LT(share, 1.0);
    }
  }
  // Rounding cannot lead out: a share of exactly 1 belongs to the last one as well.
  double one = 1.0;
  EXPECT_EQ(draw({0.5, 0.5}, one), 1U);
  EXPECT_LT(one, 1.0);
}

TEST(DrawByShare, PutsAShareOnABorderIntoTheUpperInterval) {
  double share = 0.5;
  EXPECT_EQ(draw({1.0, 1.0}, share), 1U);
  EXPECT_EQ(share, 0.0);
}

// Robots with the shares (i + ½)/N: after any number of splits each count is right to within one.
TEST(DrawByShare, SplitsASwarmToWithinOneRobot) {
  Rng rng(3);
  for (int round = 0; round < 50; ++round) {
    const std::vector<double> first = random_masses(rng), second = random_masses(rng);
    const double total_first = std::accumulate(first.begin(), first.end(), 0.0);
    const double total_second = std::accumulate(second.begin(), second.end(), 0.0);
    const int robots = 1 + static_cast<int>(rng() % 400);
    std::map<std::pair<std::size_t, std::size_t>, int> counts;
    for (int i = 0; i < robots; ++i) {
      double share = (i + 0.5) / robots;
      const std::size_t a = draw(first, share);
      const std::size_t b = draw(second, share);
      ++counts[{a, b}];
    }
    for (std::size_t a = 0; a < first.size(); ++a) {
      for (std::size_t b = 0; b < second.size(); ++b) {
        const double exact = robots * first[a] / total_first * second[b] / total_second;
        EXPECT_LT(std::abs(counts[{a, b}] - exact), 1.0 + 1e-9);
      }
    }
  }
}

TEST(DrawSource, FollowsTheMassesOfTheSources) {
  const FlowPlan plan = crossing();
  int first = 0;
  for (int i = 0; i < 1000; ++i) {
    double share = (i + 0.5) / 1000;
    first += draw_source(plan, share) == 0 ? 1 : 0;
  }

  EXPECT_EQ(first, 300);
}

TEST(PositionInFlow, IsTheLegInUseAtTheTime) {
  const FlowPlan plan = crossing();
  struct Case {
    std::size_t source;
    double share, at_s;
    std::uint32_t leg, sink;
  };
  constexpr std::uint32_t kAtSink = FlowPosition::kAtSink;
  const Case cases[] = {{0, 0.1, -5, 0, 3},      {0, 0.1, 0, 0, 3},        {1, 0.1, 3.9, 1, 3},
                        {0, 0.1, 4, 2, 3},       {1, 0.9, 4, 3, 4},        {0, 0.59, 9.9, 2, 3},
                        {0, 0.61, 9.9, 3, 4},    {0, 0.1, 10, kAtSink, 3}, {1, 0.9, 10, 3, 4},
                        {1, 0.9, 20, kAtSink, 4}};
  for (const auto& [source, share, at_s, leg, sink] : cases) {
    const FlowPosition position = position_in_flow(plan, source, share, MissionTime(at_s));

    EXPECT_EQ(position.leg, leg) << source << ' ' << share << ' ' << at_s;
    EXPECT_EQ(position.sink, sink) << source << ' ' << share << ' ' << at_s;
  }
}

// A swarm drawn leg by leg has, at every time, the masses of the plan's mixture.
TEST(PositionInFlow, PutsTheMassOfThePlanOnEachLeg) {
  const FlowPlan plan = crossing();
  constexpr int kRobots = 1000;
  for (const double at_s : {0.0, 2.0, 4.0, 9.0, 12.0, 25.0}) {
    std::map<std::uint32_t, int> on_leg;
    for (int i = 0; i < kRobots; ++i) {
      double share = (i + 0.5) / kRobots;
      const std::size_t source = draw_source(plan, share);
      ++on_leg[position_in_flow(plan, source, share, MissionTime(at_s)).leg];
    }
    for (std::uint32_t leg = 0; leg < plan.legs().size(); ++leg) {
      const PlanLeg& l = plan.legs()[leg];
      const bool in_use = plan.nodes()[l.from].time <= MissionTime(at_s) &&
                          MissionTime(at_s) < plan.nodes()[l.to].time;
      EXPECT_NEAR(on_leg[leg], in_use ? kRobots * l.mass : 0.0, 2.0) << at_s << ' ' << leg;
    }
  }
}

// A flow whose mass stays where it is: no leg at all.
TEST(PositionInFlow, IsTheSourceItselfWhereNoLegLeavesIt) {
  const FlowPlan plan =
      FlowPlan::make({{Gaussian::from_parameters({0, 0}, 1, 1, 0), MissionTime(0), 1.0}}, {})
          .value();

  const FlowPosition position = position_in_flow(plan, 0, 0.5, MissionTime(-1));

  EXPECT_EQ(position.leg, FlowPosition::kAtSink);
  EXPECT_EQ(position.sink, 0U);
}

}  // namespace
}  // namespace swarm
