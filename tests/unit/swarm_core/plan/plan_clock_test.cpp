// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/plan_clock.hpp"

#include <gtest/gtest.h>

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

TEST(PlanClock, TheNewestReadingHolds) {
  const std::vector<PlanClock> readings{{at_s(10), 1, 0.0, 0.0}, {at_s(12), 1, 0.0, 0.5}};

  EXPECT_EQ(clock_at(readings, at_s(9)), nullptr);
  EXPECT_EQ(clock_at(readings, at_s(11)), &readings[0]);
  EXPECT_EQ(clock_at(readings, at_s(12)), &readings[1]);
  EXPECT_DOUBLE_EQ(clock_at(readings, at_s(16))->plan_time_at_s(at_s(16)), 2.0);
}

}  // namespace
}  // namespace swarm
