// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/world_change.hpp"

#include <algorithm>
#include <tuple>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

World world_of(std::vector<Obstacle> obstacles) {
  return World::make({{0, 0}, {100, 100}}, std::move(obstacles)).value();
}

// One of a few shapes, so that worlds have many in common and some more than once. Discs and
// squares of the same number have the same box.
Obstacle shape(std::uint64_t number) {
  const double x = 10.0 + 10.0 * static_cast<double>(number / 2 % 3);
  const double y = 10.0 + 10.0 * static_cast<double>(number / 6);
  if (number % 2 == 0) return Circle{{x, y}, 2.0};
  return Polygon::make({{x - 2, y - 2}, {x + 2, y - 2}, {x + 2, y + 2}, {x - 2, y + 2}}).value();
}
constexpr std::uint64_t kShapes = 12;

std::vector<std::tuple<double, double>> corners(const std::vector<Box>& boxes) {
  std::vector<std::tuple<double, double>> all;
  for (const Box& box : boxes) all.emplace_back(box.min_m.x(), box.min_m.y());
  std::sort(all.begin(), all.end());
  return all;
}

TEST(WorldChange, IsTheDifferenceOfTwoMultisetsOfShapes) {
  Rng rng(1);
  for (int i = 0; i < 500; ++i) {
    std::vector<Obstacle> before;
    std::vector<Obstacle> after;
    std::vector<int> surplus(kShapes, 0);  // how many more of each shape there are afterwards
    for (std::uint64_t k = rng() % 8; k > 0; --k) {
      const std::uint64_t number = rng() % kShapes;
      before.push_back(shape(number));
      --surplus[number];
    }
    for (std::uint64_t k = rng() % 8; k > 0; --k) {
      const std::uint64_t number = rng() % kShapes;
      after.push_back(shape(number));
      ++surplus[number];
    }
    std::vector<Obstacle> added;
    std::vector<Obstacle> removed;
    for (std::uint64_t number = 0; number < kShapes; ++number) {
      for (int k = 0; k < surplus[number]; ++k) added.push_back(shape(number));
      for (int k = 0; k > surplus[number]; --k) removed.push_back(shape(number));
    }
    const auto boxes_of = [](const std::vector<Obstacle>& obstacles) {
      std::vector<Box> boxes;
      const World world = world_of(obstacles);
      for (const ConvexObstacle& part : world.convex_obstacles()) {
        boxes.push_back(part.box);
      }
      return boxes;
    };

    const WorldChange change = world_change(world_of(before), world_of(after));

    EXPECT_EQ(corners(change.added), corners(boxes_of(added))) << i;
    EXPECT_EQ(corners(change.removed), corners(boxes_of(removed))) << i;
    EXPECT_EQ(change.empty(), added.empty() && removed.empty());
  }
}

TEST(WorldChange, DistinguishesShapesOfTheSameBox) {
  // A disc and the square around it; a triangle and its mirror image.
  const Obstacle disc = Circle{{10, 10}, 2.0};
  const Obstacle square = Polygon::make({{8, 8}, {12, 8}, {12, 12}, {8, 12}}).value();
  const Obstacle rising = Polygon::make({{0, 0}, {4, 0}, {4, 4}}).value();
  const Obstacle falling = Polygon::make({{0, 0}, {4, 0}, {0, 4}}).value();
  for (const auto& [one, other] : {std::pair{disc, square}, {rising, falling}}) {
    const WorldChange change = world_change(world_of({one}), world_of({other}));
    EXPECT_EQ(change.added.size(), 1U);
    EXPECT_EQ(change.removed.size(), 1U);
  }
}

TEST(WorldChange, ComparesAConcaveObstacleByItsConvexParts) {
  const Obstacle corner =
      Polygon::make({{10, 10}, {30, 10}, {30, 15}, {15, 15}, {15, 30}, {10, 30}}).value();
  const World with = world_of({corner, Circle{{50, 50}, 1.0}});
  const World without = world_of({Circle{{50, 50}, 1.0}});

  const WorldChange change = world_change(with, without);

  EXPECT_TRUE(change.added.empty());
  EXPECT_EQ(change.removed.size(), with.convex_obstacles().size() - 1);
  EXPECT_GT(change.removed.size(), 1U);
}

}  // namespace
}  // namespace swarm::planner
