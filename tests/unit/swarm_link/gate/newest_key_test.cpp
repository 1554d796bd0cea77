// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gate/newest_key.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

TEST(NewestKey, PassesOnlyWhatIsNewer) {
  NewestKey<int> sut;
  EXPECT_TRUE(sut.accept(-3));
  EXPECT_EQ(sut.accept(-3).error(), RefusalReason::kDuplicate);
  EXPECT_EQ(sut.accept(-4).error(), RefusalReason::kStale);
  EXPECT_TRUE(sut.accept(7));
  EXPECT_EQ(sut.accept(6).error(), RefusalReason::kStale);
}

TEST(NewestKey, DoesNotPassWhatWasKnownFromTheBeginning) {
  NewestKey<int> sut(0);
  EXPECT_EQ(sut.accept(0).error(), RefusalReason::kDuplicate);
  EXPECT_EQ(sut.accept(-1).error(), RefusalReason::kStale);
  EXPECT_TRUE(sut.accept(1));
}

TEST(NewestKey, RisesOverAnyStream) {
  using Key = std::pair<std::uint64_t, std::uint64_t>;
  Rng rng(5);
  NewestKey<Key> sut({0, 0});
  Key newest{0, 0};
  for (int i = 0; i < 10'000; ++i) {
    const Key next{rng() % 50, rng() % 50};
    EXPECT_EQ(sut.accept(next).has_value(), next > newest);
    newest = std::max(newest, next);
  }
}

}  // namespace
}  // namespace swarm::link
