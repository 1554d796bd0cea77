// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/cell.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Cell, HoldsItsLowerEdgesOnly) {
  EXPECT_EQ(cell_of({0.0, 0.0}, 20.0), (Cell{0, 0}));
  EXPECT_EQ(cell_of({19.999, 20.0}, 20.0), (Cell{0, 1}));
  EXPECT_EQ(cell_of({-1e-9, -20.0}, 20.0), (Cell{-1, -1}));
}

TEST(Cell, ContainsThePointsSortedIntoIt) {
  Rng rng(1);
  for (int i = 0; i < 10'000; ++i) {
    const double size_m = uniform(rng, 0.5, 50.0);
    const Vec2 p(uniform(rng, -500.0, 500.0), uniform(rng, -500.0, 500.0));

    const Cell cell = cell_of(p, size_m);

    const double rounding_m = 1e-9;  // of the division by the size, at 500 m
    EXPECT_GE(p.x(), cell.x * size_m - rounding_m);
    EXPECT_LT(p.x(), (cell.x + 1) * size_m + rounding_m);
    EXPECT_GE(p.y(), cell.y * size_m - rounding_m);
    EXPECT_LT(p.y(), (cell.y + 1) * size_m + rounding_m);
  }
}

TEST(Cell, ClampsWhatIsFarOrNotANumber) {
  EXPECT_EQ(cell_of({1e300, -1e300}, 20.0), (Cell{1'000'000, -1'000'000}));
  EXPECT_EQ(cell_of({kInfinity, -kInfinity}, 20.0), (Cell{1'000'000, -1'000'000}));
  EXPECT_EQ(cell_of({kNaN, 5.0}, 20.0), (Cell{-1'000'000, 0}));
}

// A disc touches a square iff the square's point nearest to the centre is within the radius.
std::vector<Cell> touching_by_brute_force(const Vec2& center_m, double radius_m, double size_m) {
  std::vector<Cell> cells;
  for (int x = -40; x <= 40; ++x) {
    for (int y = -40; y <= 40; ++y) {
      const Vec2 nearest(std::clamp(center_m.x(), x * size_m, (x + 1) * size_m),
                         std::clamp(center_m.y(), y * size_m, (y + 1) * size_m));
      if ((nearest - center_m).norm() <= radius_m) cells.push_back({x, y});
    }
  }
  return cells;
}

TEST(CellsTouching, AreThoseOfTheBruteForceSearch) {
  Rng rng(2);
  for (int i = 0; i < 2'000; ++i) {
    const double size_m = uniform(rng, 4.0, 30.0);
    const double radius_m = uniform(rng, 0.0, 12.0);
    const Vec2 center_m(uniform(rng, -60.0, 60.0), uniform(rng, -60.0, 60.0));

    EXPECT_EQ(cells_touching(center_m, radius_m, size_m),
              touching_by_brute_force(center_m, radius_m, size_m));
  }
}

TEST(CellsTouching, AreInOrderAndHoldTheOwnCell) {
  Rng rng(3);
  for (int i = 0; i < 1'000; ++i) {
    const Vec2 center_m(uniform(rng, -60.0, 60.0), uniform(rng, -60.0, 60.0));

    const auto cells = cells_touching(center_m, uniform(rng, 0.0, 30.0), 7.0);

    EXPECT_TRUE(std::is_sorted(cells.begin(), cells.end()));
    EXPECT_TRUE(std::binary_search(cells.begin(), cells.end(), cell_of(center_m, 7.0)));
  }
}

TEST(CellsTouching, AreBoundedForAnyCentre) {
  EXPECT_EQ(cells_touching({kNaN, kInfinity}, 5.0, 20.0).size(), 1U);
  EXPECT_EQ(cells_touching({1e300, 0.5}, 0.1, 20.0).size(), 1U);
}

}  // namespace
}  // namespace swarm::link
