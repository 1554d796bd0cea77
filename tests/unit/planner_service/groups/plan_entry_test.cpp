// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/groups/plan_entry.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

TEST(PlanEntry, SharesOfAGroupKeepTheirOrderAndStayBelowOne) {
  for (const std::uint32_t robots : {1U, 2U, 3U, 64U, 1000U, 50'000U}) {
    std::uint16_t before = 0;
    for (std::uint32_t i = 0; i < robots; ++i) {
      const double share = (i + 0.5) / robots;
      const PlanEntry entry{.source = 0, .share = PlanEntry::share_of(share)};
      ASSERT_GE(entry.share, before);
      ASSERT_LT(entry.draw_share(), 1.0);
      ASSERT_LE(entry.draw_share(), share);
      ASSERT_GT(entry.draw_share(), share - 1.0 / 65536.0);
      before = entry.share;
    }
  }
  EXPECT_EQ(PlanEntry::share_of(0.0), 0);
  EXPECT_EQ(PlanEntry::share_of(std::nextafter(1.0, 0.0)), 65535);
}

}  // namespace
}  // namespace swarm::planner
