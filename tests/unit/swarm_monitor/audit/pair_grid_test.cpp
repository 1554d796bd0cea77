// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/pair_grid.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::monitor {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs all_pairs(const std::vector<PairGrid::Item>& items) {
  Pairs pairs;
  for (const auto& a : items) {
    for (const auto& b : items) {
      if (a.id < b.id && (a.box.min_m.array() <= b.box.max_m.array()).all() &&
          (b.box.min_m.array() <= a.box.max_m.array()).all()) {
        pairs.emplace_back(a.id, b.id);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST(PairGrid, FindsEveryOverlapOnceWhateverTheSizes) {
  Rng rng(8);
  for (int round = 0; round < 200; ++round) {
    std::vector<PairGrid::Item> items;
    for (std::uint32_t i = 0; i < 60; ++i) {
      const Vec2 low(uniform(rng, -20, 20), uniform(rng, -20, 20));
      // A few boxes span hundreds of cells, some touch cell borders exactly, some are points.
      const double largest = i % 10 == 0 ? 40.0 : 3.0;
      Vec2 size(uniform(rng, 0, largest), uniform(rng, 0, largest));
      if (i % 7 == 0) size.setZero();
      const Vec2 corner = i % 5 == 0 ? Vec2(low.array().round()) : low;
      items.push_back({i, {corner, corner + size}});
    }
    Pairs found;
    PairGrid(items, 1.0).for_each_pair([&](auto a, auto b) { found.emplace_back(a, b); });
    std::sort(found.begin(), found.end());

    EXPECT_EQ(found, all_pairs(items));
  }
}

TEST(PairGrid, OfNothingHasNoPairs) {
  PairGrid({}, 1.0).for_each_pair([](auto, auto) { FAIL(); });
}

}  // namespace
}  // namespace swarm::monitor
