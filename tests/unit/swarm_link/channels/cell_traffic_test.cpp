// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/cell_traffic.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

constexpr CellOptions kOptions{.cell_size_m = 10.0,
                               .communication_radius_m = 4.0,
                               .join_margin_m = 1.0,
                               .leave_margin_m = 3.0};

// Cells 0 to 4 in both directions; `#` a wanted cell. The first line is the northernmost, as on a
// map.
std::string drawn(std::span<const Cell> cells) {
  std::string map;
  for (std::int32_t y = 4; y >= 0; --y) {
    for (std::int32_t x = 0; x < 5; ++x) {
      map += std::binary_search(cells.begin(), cells.end(), Cell{x, y}) ? '#' : '.';
    }
    map += '\n';
  }
  return map;
}

std::string wanted_at(CellInterest& sut, const std::vector<Vec2>& positions_m) {
  return drawn(sut.update(positions_m));
}

TEST(CellInterest, WantsTheCellsThatTheRadiusAndJoinMarginReach) {
  CellInterest near_a_corner(kOptions);
  EXPECT_EQ(wanted_at(near_a_corner, {{24.9, 24.9}}),
            ".....\n"
            ".....\n"
            ".##..\n"
            "..#..\n"
            ".....\n");
  CellInterest on_the_edge(kOptions);  // 5 m from every border: a lower edge belongs to a cell
  EXPECT_EQ(wanted_at(on_the_edge, {{25.0, 25.0}}),
            ".....\n"
            "..#..\n"
            "..##.\n"
            ".....\n"
            ".....\n");
  CellInterest of_two(kOptions);
  EXPECT_EQ(wanted_at(of_two, {{5.1, 44.9}, {41.0, 1.0}}),
            "##...\n"
            "#....\n"
            ".....\n"
            ".....\n"
            "...##\n");
}

TEST(CellInterest, KeepsACellUntilTheRobotIsBeyondTheLeaveMargin) {
  const std::string west =
      ".....\n"
      ".....\n"
      ".##..\n"
      ".....\n"
      ".....\n";
  const std::string at_start =
      ".....\n"
      ".....\n"
      "..#..\n"
      ".....\n"
      ".....\n";
  // A cell with room, so that only the western border matters.
  CellOptions options = kOptions;
  options.communication_radius_m = 1.0;
  CellInterest sut(options);
  EXPECT_EQ(wanted_at(sut, {{22.1, 25.0}}), at_start) << "not joined yet";
  EXPECT_FALSE(sut.covers({19.9, 25.0}));
  EXPECT_EQ(wanted_at(sut, {{21.9, 25.0}}), west) << "within radius + join margin";
  EXPECT_TRUE(sut.covers({19.9, 25.0}));
  EXPECT_EQ(wanted_at(sut, {{23.9, 25.0}}), west) << "still within radius + leave margin";
  EXPECT_EQ(wanted_at(sut, {{24.1, 25.0}}), at_start) << "left";
  EXPECT_EQ(wanted_at(sut, {{23.9, 25.0}}), at_start) << "the leave margin does not join";
}

TEST(CellInterest, WantsNothingWithoutRobots) {
  CellInterest sut(kOptions);
  EXPECT_TRUE(sut.update({}).empty());
  const Vec2 p(25.0, 25.0);
  EXPECT_FALSE(sut.update({&p, 1}).empty());
  EXPECT_TRUE(sut.update({}).empty());
}

// The definition, cell by cell, on sets.
TEST(CellInterest, IsTheDefinitionOverRandomWalks) {
  Rng rng(11);
  CellInterest sut(kOptions);
  std::vector<Vec2> robots(4, Vec2(25.0, 25.0));
  std::set<Cell> before;
  int kept_only = 0;
  for (int step = 0; step < 2'000; ++step) {
    for (Vec2& p : robots) p += Vec2(uniform(rng, -2.0, 2.0), uniform(rng, -2.0, 2.0));
    const auto nearest_m = [&](const Cell& cell) {
      double nearest = std::numeric_limits<double>::max();
      for (const Vec2& p : robots) {
        const Vec2 low = Vec2(cell.x, cell.y) * kOptions.cell_size_m;
        const Vec2 inside = p.cwiseMax(low).cwiseMin(low + Vec2::Constant(kOptions.cell_size_m));
        nearest = std::min(nearest, (inside - p).norm());
      }
      return nearest;
    };
    std::set<Cell> expected;
    for (const Vec2& p : robots) {
      const Cell own = cell_of(p, kOptions.cell_size_m);
      for (std::int32_t x = own.x - 2; x <= own.x + 2; ++x) {
        for (std::int32_t y = own.y - 2; y <= own.y + 2; ++y) {
          const double distance_m = nearest_m({x, y});
          const bool joins = distance_m <= 5.0, stays = distance_m <= 7.0;
          if (joins || (stays && before.contains({x, y}))) expected.insert({x, y});
          kept_only += !joins && stays && before.contains({x, y}) ? 1 : 0;
        }
      }
    }

    const auto wanted = sut.update(robots);

    ASSERT_TRUE(std::is_sorted(wanted.begin(), wanted.end()));
    ASSERT_EQ(std::set<Cell>(wanted.begin(), wanted.end()), expected) << "step " << step;
    ASSERT_EQ(wanted.size(), expected.size()) << "no cell twice";
    before = expected;
  }
  EXPECT_GT(kept_only, 100) << "the walk reaches the hysteresis";
}

TEST(CellsAround, AreTheUnionInAnyOrderOfTheRobots) {
  Rng rng(12);
  for (int round = 0; round < 200; ++round) {
    std::vector<Vec2> centers_m(1 + rng() % 6);
    for (Vec2& c : centers_m) c = {uniform(rng, -40.0, 40.0), uniform(rng, -40.0, 40.0)};
    const double radius_m = uniform(rng, 0.0, 9.0);
    std::set<Cell> expected;
    for (const Vec2& c : centers_m) {
      const auto cells = cells_touching(c, radius_m, 7.0);
      expected.insert(cells.begin(), cells.end());
    }

    std::vector<Cell> cells, reversed;
    cells_around(centers_m, radius_m, 7.0, cells);
    std::reverse(centers_m.begin(), centers_m.end());
    cells_around(centers_m, radius_m, 7.0, reversed);

    EXPECT_EQ(cells, std::vector<Cell>(expected.begin(), expected.end()));
    EXPECT_EQ(reversed, cells);
  }
}

RobotStateMessage state(std::uint32_t robot, double x_m, double y_m) {
  return {.robot_id = robot, .sequence_number = robot + 1, .x_m = x_m, .y_m = y_m};
}

TEST(LeftCells, NameTheOldCellForTheNextStatesOfARobot) {
  LeftCells sut;
  EXPECT_FALSE(sut.update(3, {0, 0})) << "it has left none";
  EXPECT_FALSE(sut.update(3, {0, 0}));
  for (std::uint32_t i = 0; i < LeftCells::kTimes; ++i) {
    EXPECT_EQ(sut.update(3, {1, 0}), (Cell{0, 0})) << i;
    EXPECT_FALSE(sut.update(4, {1, 0})) << "another robot";
  }
  EXPECT_FALSE(sut.update(3, {1, 0}));
  EXPECT_EQ(sut.update(3, {0, 0}), (Cell{1, 0})) << "it returns";
  EXPECT_EQ(sut.update(3, {0, 1}), (Cell{0, 0})) << "the last cell counts";
}

TEST(CellBatches, ReportARobotInTheCellThatItHasLeft) {
  CellBatches sut(10.0);
  LeftCells left;
  RobotStateMessage state{.robot_id = 3, .x_m = 9.0, .y_m = 1.0};
  EXPECT_EQ(sut.sort({&state, 1}, &left).size(), 1U);
  state.x_m = 11.0;

  const auto batches = sut.sort({&state, 1}, &left);

  ASSERT_EQ(batches.size(), 2U);
  EXPECT_EQ(batches[0].cell_x, 0);
  EXPECT_EQ(batches[1].cell_x, 1);
  for (const CellStatesMessage& batch : batches) {
    ASSERT_EQ(batch.states.size(), 1U);
    EXPECT_EQ(batch.states[0].x_m, 11.0) << "where it is now";
  }
}

TEST(CellBatches, SortNothingIntoNoBatch) {
  CellBatches sut(10.0);
  EXPECT_TRUE(sut.sort({}).empty());
}

// Random states against a map of cells; also what remains from larger calls before.
TEST(CellBatches, HoldEachStateOnceInItsCellAndInTheGivenOrder) {
  Rng rng(13);
  CellBatches sut(10.0);
  for (const std::size_t size : {1'500U, 3U, 800U, 0U, 40U}) {
    std::vector<RobotStateMessage> states;
    std::map<Cell, std::vector<RobotStateMessage>> expected;
    for (std::uint32_t i = 0; i < size; ++i) {
      states.push_back(state(i, uniform(rng, -15.0, 15.0), uniform(rng, -15.0, 15.0)));
      expected[cell_of({states[i].x_m, states[i].y_m}, 10.0)].push_back(states[i]);
    }

    std::map<Cell, std::vector<RobotStateMessage>> sorted;
    for (const CellStatesMessage& batch : sut.sort(states)) {
      EXPECT_EQ(batch.schema_version, kSchemaVersion);
      EXPECT_FALSE(batch.states.empty());
      EXPECT_LE(batch.states.size(), kMaxCellStates);
      auto& cell = sorted[{batch.cell_x, batch.cell_y}];
      cell.insert(cell.end(), batch.states.begin(), batch.states.end());
    }
    EXPECT_EQ(sorted, expected);
  }
}

TEST(CellBatches, FillEachBatchBeforeTheNextBegins) {
  CellBatches sut(10.0);
  const std::vector<std::pair<std::size_t, std::size_t>> cases = {{kMaxCellStates - 1, 1},
                                                                  {kMaxCellStates, 1},
                                                                  {kMaxCellStates + 1, 2},
                                                                  {2 * kMaxCellStates, 2},
                                                                  {2 * kMaxCellStates + 1, 3}};
  for (const auto& [states, batches] : cases) {
    const auto sorted = sut.sort(std::vector<RobotStateMessage>(states, state(1, 5.0, 5.0)));
    ASSERT_EQ(sorted.size(), batches) << states;
    for (const auto& batch : sorted.first(batches - 1)) {
      EXPECT_EQ(batch.states.size(), kMaxCellStates);
    }
  }
}

TEST(CellBatches, KeepStatesThatAreNowhere) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  CellBatches sut(10.0);
  const std::vector<RobotStateMessage> states = {state(1, kNaN, 5.0), state(2, 1e300, 5.0)};
  EXPECT_EQ(sut.sort(states).size(), 2U) << "the receiver's gate refuses them and counts them";
}

}  // namespace
}  // namespace swarm::link
