// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/pace.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

std::vector<double> paced(std::size_t nodes, const std::vector<PacedLeg>& legs) {
  return paced_times_s(earliest_times_s(nodes, legs).value(), legs);
}

TEST(Pace, SpreadsWaitingEvenlyOverTheShorterPath) {
  // 0 -> 1 -> 3 takes 10 s, 0 -> 2 -> 3 would take 5.
  const auto times_s = paced(4, {{0, 1, 6}, {1, 3, 4}, {0, 2, 2}, {2, 3, 3}});

  EXPECT_DOUBLE_EQ(times_s[3], 10.0);
  EXPECT_DOUBLE_EQ(times_s[1], 6.0);
  EXPECT_DOUBLE_EQ(times_s[2], 4.0);
}

TEST(Pace, PacesTheTightestPathFirst) {
  // 0 -8- 2 -2- 3 and 1 -2- 2 -6- 4; both goals, 3 and 4, are also reached by slower paths.
  const auto times_s =
      paced(5, {{0, 2, 8}, {2, 3, 2}, {1, 2, 2}, {2, 4, 6}, {0, 3, 20}, {0, 4, 15}});

  // The paths through 2 take 10 of 20 and 14 of 15 s (0 to 4), the tightest: 8 / 14 of 15 s.
  EXPECT_DOUBLE_EQ(times_s[3], 20.0);
  EXPECT_DOUBLE_EQ(times_s[4], 15.0);
  EXPECT_DOUBLE_EQ(times_s[2], 15.0 * 8.0 / 14.0);
}

TEST(Pace, HasNoTimesForACycle) {
  const std::vector<PacedLeg> circle{{0, 1, 1}, {1, 2, 1}, {2, 1, 1}};

  EXPECT_FALSE(earliest_times_s(3, circle).has_value());
}

TEST(Pace, GivesEveryLegItsLeastTimeInRandomGraphs) {
  Rng rng(1);
  for (int round = 0; round < 200; ++round) {
    const std::size_t nodes = 3 + rng() % 15;
    std::vector<PacedLeg> legs;
    for (std::uint32_t v = 1; v < nodes; ++v) {
      for (std::uint32_t u = 0; u < v; ++u) {
        if (uniform01(rng) < 0.3) legs.push_back({u, v, uniform(rng, 0.1, 10.0)});
      }
    }
    std::shuffle(legs.begin(), legs.end(), rng);
    const auto earliest_s = earliest_times_s(nodes, legs).value();

    const auto times_s = paced_times_s(earliest_s, legs);

    std::vector<bool> is_left(nodes, false);
    for (const PacedLeg& leg : legs) {
      EXPECT_GE(times_s[leg.to] - times_s[leg.from], leg.least_s - 1e-9);
      is_left[leg.from] = true;
    }
    for (std::size_t v = 0; v < nodes; ++v) {
      EXPECT_GE(times_s[v], earliest_s[v] - 1e-9);
      if (is_left[v]) continue;
      EXPECT_EQ(times_s[v], earliest_s[v]);
    }
  }
}

}  // namespace
}  // namespace swarm::planner
