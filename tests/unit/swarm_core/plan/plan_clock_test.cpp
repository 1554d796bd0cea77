// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/plan_clock.hpp"

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

UtcTime at_s(double s) { return UtcTime(from_seconds(s)); }

TEST(PlanClock, LinesReadBack) {
  const PlanClock first{at_s(10), 1, 0.0, 1.0};
  const PlanClock second{at_s(12.5), 2, 0.1, 0.37};

  const auto read = read_plan_clock(plan_clock_line(first) + plan_clock_line(second));

  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].stamp, second.stamp);
  EXPECT_EQ(read[1].plan_version, 2U);
  EXPECT_EQ(read[1].plan_time_s, 0.1);
  EXPECT_EQ(read[1].rate, 0.37);
}

TEST(PlanClock, WhatIsNoReadingIsLeftOut) {
  const std::string good = plan_clock_line({at_s(10), 1, 0.0, 1.0});
  const std::string earlier = plan_clock_line({at_s(9), 1, 0.0, 1.0});
  const std::string fast =
      R"({"utc_ns": 11000000000, "plan_version": 1, "plan_time_s": 1, "rate": 2})";

  EXPECT_EQ(read_plan_clock(good + earlier + fast + "\n[]\nnonsense\n{\"utc_ns\": 3}\n" +
                            good.substr(0, 20))
                .size(),
            1U);
  EXPECT_TRUE(read_plan_clock("").empty());
}

TEST(PlanClock, NumbersTooLargeForAReadingAreLeftOut) {
  const auto with = [](const std::string& stamp, const std::string& version) {
    return "{\"utc_ns\": " + stamp + ", \"plan_version\": " + version +
           ", \"plan_time_s\": 1, \"rate\": 1}\n";
  };
  EXPECT_EQ(read_plan_clock(with("9223372036854775807", "4294967295")).size(), 1U);
  EXPECT_EQ(read_plan_clock(with("-5", "0")).size(), 1U);
  for (const char* stamp : {"9223372036854775808", "18446744073709551615", "1.5", "1e9", "\"5\""}) {
    EXPECT_TRUE(read_plan_clock(with(stamp, "1")).empty()) << stamp;
  }
  for (const char* version : {"4294967296", "4294967297", "-1", "1.0", "null"}) {
    EXPECT_TRUE(read_plan_clock(with("5", version)).empty()) << version;
  }
}

// A planner may be killed at any byte, and a disk may damage any.
TEST(PlanClock, DamageLeavesReadingsInOrderWithRatesInRange) {
  constexpr std::string_view kBytes = "0123456789-+.eE,:{}[]\"\n x";
  std::string file;
  for (int i = 0; i < 20; ++i) file += plan_clock_line({at_s(i), 1, 0.5 * i, 0.05 * i});
  Rng rng(1);
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = file;
    for (std::uint64_t k = rng() % 4 + 1; k > 0; --k) {
      damaged[rng() % damaged.size()] = kBytes[rng() % kBytes.size()];
    }
    damaged.resize(damaged.size() - rng() % 50);

    const auto readings = read_plan_clock(damaged);

    EXPECT_LE(readings.size(), 20U);
    for (std::size_t i = 0; i < readings.size(); ++i) {
      EXPECT_TRUE(readings[i].rate >= 0.0 && readings[i].rate <= 1.0);
      EXPECT_TRUE(i == 0 || readings[i - 1].stamp <= readings[i].stamp);
    }
  }
}

// Reference: a scan of all readings. Several may have the same stamp; the last of them holds.
TEST(PlanClock, TheReadingInForceIsTheOneThatAScanFinds) {
  Rng rng(2);
  for (int round = 0; round < 300; ++round) {
    std::vector<PlanClock> readings;
    double s = 0.0;
    for (std::uint64_t k = rng() % 8; k > 0; --k) {
      s += static_cast<double>(rng() % 3);
      readings.push_back({.stamp = at_s(s), .plan_version = 1, .plan_time_s = s, .rate = 1.0});
    }
    for (double t = -1.0; t < 20.0; t += 0.5) {
      const PlanClock* expected = nullptr;
      for (const PlanClock& reading : readings) {
        if (reading.stamp <= at_s(t)) expected = &reading;
      }
      EXPECT_EQ(clock_at(readings, at_s(t)), expected) << t;
    }
  }
}

TEST(PlanClock, TheNewestReadingHolds) {
  const std::vector<PlanClock> readings{{at_s(10), 1, 0.0, 0.0}, {at_s(12), 1, 0.0, 0.5}};

  EXPECT_EQ(clock_at(readings, at_s(9)), nullptr);
  EXPECT_EQ(clock_at(readings, at_s(11)), &readings[0]);
  EXPECT_EQ(clock_at(readings, at_s(12)), &readings[1]);
  EXPECT_DOUBLE_EQ(clock_at(readings, at_s(16))->plan_time_at_s(at_s(16)), 2.0);
}

}  // namespace
}  // namespace swarm
