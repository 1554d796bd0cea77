// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/heard_cells.hpp"

#include <set>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

TEST(HeardCells, VisitAllThatIsNearOnceAndLittleElse) {
  constexpr double kCell_m = 4.0, kSide_m = 100.0;
  constexpr std::uint32_t kHeard = 3000;
  Rng rng(1);
  std::vector<HeardState> heard(kHeard);
  for (std::uint32_t i = 0; i < kHeard; ++i) {
    heard[i].report.robot = RobotId(i);
    heard[i].report.position_m = {uniform(rng, -kSide_m, kSide_m), uniform(rng, -kSide_m, kSide_m)};
  }
  HeardCells cells(kCell_m);
  cells.sort(heard);

  std::size_t visited = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec2 at_m(uniform(rng, -kSide_m, kSide_m), uniform(rng, -kSide_m, kSide_m));
    std::set<std::uint32_t> seen;
    cells.visit_near(at_m, [&](const HeardState& state) {
      EXPECT_TRUE(seen.insert(state.report.robot.value()).second);
    });
    visited += seen.size();
    for (const HeardState& state : heard) {
      if ((state.report.position_m - at_m).norm() <= kCell_m) {
        EXPECT_TRUE(seen.count(state.report.robot.value()) > 0);
      }
    }
  }
  EXPECT_LT(visited, 500 * kHeard / 50);
}

TEST(HeardCells, ForgetWhatWasHeardBefore) {
  std::vector<HeardState> heard(5);
  HeardCells cells(4.0);
  const auto count = [&] {
    int visited = 0;
    cells.visit_near({0, 0}, [&](const HeardState&) { ++visited; });
    return visited;
  };
  EXPECT_EQ(count(), 0);
  cells.sort(heard);
  EXPECT_EQ(count(), 5);
  cells.sort({});
  EXPECT_EQ(count(), 0);
}

}  // namespace
}  // namespace swarm::agent
