// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbours/received_cells.hpp"

#include <set>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

TEST(ReceivedCells, VisitAllThatIsNearOnceAndLittleElse) {
  constexpr double kCell_m = 4.0, kSide_m = 100.0;
  constexpr std::uint32_t kReceived = 3000;
  Rng rng(1);
  std::vector<ReceivedState> received(kReceived);
  for (std::uint32_t i = 0; i < kReceived; ++i) {
    received[i].report.robot = RobotId(i);
    received[i].report.position_m = {uniform(rng, -kSide_m, kSide_m),
                                     uniform(rng, -kSide_m, kSide_m)};
  }
  ReceivedCells cells(kCell_m);
  cells.sort(received);

  std::size_t visited = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec2 at_m(uniform(rng, -kSide_m, kSide_m), uniform(rng, -kSide_m, kSide_m));
    std::set<std::uint32_t> seen;
    cells.visit_near(at_m, [&](const ReceivedState& state) {
      EXPECT_TRUE(seen.insert(state.report.robot.value()).second);
    });
    visited += seen.size();
    for (const ReceivedState& state : received) {
      if ((state.report.position_m - at_m).norm() <= kCell_m) {
        EXPECT_TRUE(seen.count(state.report.robot.value()) > 0);
      }
    }
  }
  EXPECT_LT(visited, 500 * kReceived / 50);
}

TEST(ReceivedCells, DropWhatWasReceivedBefore) {
  std::vector<ReceivedState> received(5);
  ReceivedCells cells(4.0);
  const auto count = [&] {
    int visited = 0;
    cells.visit_near({0, 0}, [&](const ReceivedState&) { ++visited; });
    return visited;
  };
  EXPECT_EQ(count(), 0);
  cells.sort(received);
  EXPECT_EQ(count(), 5);
  cells.sort({});
  EXPECT_EQ(count(), 0);
}

}  // namespace
}  // namespace swarm::agent
