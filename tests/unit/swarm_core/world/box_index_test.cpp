// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/box_index.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm {
namespace {

constexpr double kInfinity_m = std::numeric_limits<double>::infinity();

Box random_box(Rng& rng, double size_m) {
  const Vec2 at(uniform(rng, 0, 100), uniform(rng, 0, 100));
  return {at, at + Vec2(uniform(rng, 0, size_m), uniform(rng, 0, size_m))};
}

TEST(BoxIndex, FindsWhatAScanFinds) {
  Rng rng(1);
  for (const std::size_t count : {0U, 1U, 8U, 9U, 100U, 3000U}) {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < count; ++i) boxes.push_back(random_box(rng, i % 7 == 0 ? 40 : 2));
    const BoxIndex index(boxes);
    for (int query = 0; query < 300; ++query) {
      const Box place = random_box(rng, query % 3 == 0 ? 0 : 20);
      const double reach_m = query % 5 == 0 ? 0.0 : uniform(rng, 0, 15);
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < count; ++i) {
        if (place.gap_squared_m2(boxes[i]) <= reach_m * reach_m) expected.push_back(i);
      }

      std::vector<std::uint32_t> ordered;
      std::multiset<std::uint32_t> unordered;
      index.for_each_within(place, reach_m, [&](std::uint32_t i) { ordered.push_back(i); });
      const bool stopped = index.any_within(place, reach_m, [&](std::uint32_t i) {
        unordered.insert(i);
        return false;
      });

      EXPECT_EQ(ordered, expected);
      EXPECT_FALSE(stopped);
      EXPECT_TRUE(std::equal(unordered.begin(), unordered.end(), expected.begin(), expected.end()));
      EXPECT_EQ(index.any_within(place, reach_m, [](std::uint32_t) { return true; }),
                !expected.empty());
    }
  }
}

TEST(BoxIndex, AcceptsEqualBoxes) {
  const BoxIndex index(std::vector<Box>(1000, Box{{1, 1}, {2, 2}}));
  int found = 0;

  index.for_each_within({{1.5, 1.5}, {1.5, 1.5}}, 0.0, [&](std::uint32_t) { ++found; });

  EXPECT_EQ(found, 1000);
}

// The definitions, obstacle by obstacle in the order of the list, as a world of few obstacles is
// searched.
class Scan {
 public:
  explicit Scan(const World& world) : world_(world) {
    for (const Obstacle& obstacle : world.obstacles()) {
      alone_.push_back(World::make(world.bounds_m(), {obstacle}).value());
    }
  }

  SignedDistance signed_distance(const Vec2& p) const {
    SignedDistance best{kInfinity_m, Vec2::UnitX()};
    for (const World& one : alone_) {
      const SignedDistance candidate = one.signed_distance(p);
      if (candidate.distance_m < best.distance_m) best = candidate;
    }
    return best;
  }
  bool is_clear(const Vec2& p, double clearance_m) const {
    return std::all_of(alone_.begin(), alone_.end(),
                       [&](const World& one) { return one.is_clear(p, clearance_m); });
  }
  bool segment_is_free(const Vec2& a, const Vec2& b, double clearance_m) const {
    return std::all_of(alone_.begin(), alone_.end(),
                       [&](const World& one) { return one.segment_is_free(a, b, clearance_m); });
  }
  double max_cvar_m(const Gaussian& g, double k) const {
    double worst_m = -kInfinity_m;
    for (const ConvexObstacle& obstacle : world_.convex_obstacles()) {
      worst_m = std::max(worst_m, obstacle_cvar_m(g, obstacle.signed_distance(g.mean_m()), k));
    }
    return worst_m;
  }

 private:
  const World& world_;
  std::vector<World> alone_;
};

// Blocks that touch and overlap, on a lattice so that many are at exactly the same distance, and
// circles and Ls anywhere.
World dense_world(Rng& rng, int obstacles) {
  std::vector<Obstacle> list;
  for (int i = 0; i < obstacles; ++i) {
    if (i % 3 == 0) {
      list.push_back(Circle{{uniform(rng, 0, 200), uniform(rng, 0, 160)}, uniform(rng, 0.1, 6)});
      continue;
    }
    const Vec2 at(4.0 * std::floor(uniform(rng, 0, 50)), 4.0 * std::floor(uniform(rng, 0, 40)));
    if (i % 3 == 1) {
      list.push_back(
          Polygon::make({at, at + Vec2(4, 0), at + Vec2(4, 4), at + Vec2(0, 4)}).value());
    } else {
      list.push_back(Polygon::make({at, at + Vec2(8, 0), at + Vec2(8, 4), at + Vec2(4, 4),
                                    at + Vec2(4, 8), at + Vec2(0, 8)})
                         .value());
    }
  }
  return World::make({{0, 0}, {200, 160}}, std::move(list)).value();
}

TEST(World, AnswersBitForBitAsAScanOfAllObstacles) {
  Rng rng(2);
  int clear = 0;
  int blocked = 0;
  for (const int obstacles : {6, 12, 120, 600}) {
    const World original = dense_world(rng, obstacles);
    const World world = original;  // a copy answers by itself
    const Scan scan(world);
    const double k = cvar_coefficient(0.05);
    for (int query = 0; query < 2000; ++query) {
      // Half of the points on the lattice's lines and corners.
      Vec2 p(uniform(rng, -10, 210), uniform(rng, -10, 170));
      if (query % 2 == 0) p = (p / 2.0).array().floor().matrix() * 2.0;
      Vec2 q = p + Vec2(uniform(rng, -20, 20), uniform(rng, -20, 20));
      if (query % 4 == 0) q = (q / 2.0).array().floor().matrix() * 2.0;
      const double clearance_m = query % 3 == 0 ? 0.0 : uniform(rng, 0, 3);
      const Gaussian g = Gaussian::from_parameters(p, uniform(rng, 0.1, 5), 1.0, 0.3);

      const SignedDistance found = world.signed_distance(p);
      const SignedDistance expected = scan.signed_distance(p);

      EXPECT_EQ(found.distance_m, expected.distance_m);
      EXPECT_EQ(found.gradient, expected.gradient);
      EXPECT_EQ(world.is_clear(p, clearance_m), scan.is_clear(p, clearance_m));
      EXPECT_EQ(world.segment_is_free(p, q, clearance_m), scan.segment_is_free(p, q, clearance_m));
      EXPECT_EQ(max_cvar_m(g, world, k), scan.max_cvar_m(g, k));
      EXPECT_EQ(in_free(g, world, k, -0.2), scan.max_cvar_m(g, k) <= -0.2);
      (world.segment_is_free(p, q, clearance_m) ? clear : blocked) += 1;
    }
  }
  EXPECT_GT(clear, 300);
  EXPECT_GT(blocked, 300);
}

}  // namespace
}  // namespace swarm
