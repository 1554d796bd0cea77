// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/metrics/late_ticks.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace swarm {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr Duration kPeriod = milliseconds(100);

TEST(LateTicks, CountATickBeyondTwentyMilliseconds) {
  EXPECT_EQ(late_ticks(milliseconds(-5), kPeriod), 0U);
  EXPECT_EQ(late_ticks(milliseconds(20), kPeriod), 0U);
  EXPECT_EQ(late_ticks(microseconds(20'001), kPeriod), 1U);
  EXPECT_EQ(late_ticks(microseconds(99'999), kPeriod), 1U);
}

// By walking through the times at which ticks were due.
TEST(LateTicks, CountEachTickThatWasMissed) {
  for (int ms = 0; ms < 1000; ++ms) {
    std::uint32_t expected = 0;
    for (int due_ms = 0; due_ms <= ms; due_ms += 100) {
      const bool has_begun = due_ms + 100 > ms;  // the newest one that was due
      if (!has_begun || ms - due_ms > 20) ++expected;
    }
    EXPECT_EQ(late_ticks(milliseconds(ms), kPeriod), expected) << ms;
  }
}

TEST(LateTicks, CountOneTickWithoutAPeriod) {
  EXPECT_EQ(late_ticks(std::chrono::seconds(8), Duration::zero()), 1U);
}

}  // namespace
}  // namespace swarm
