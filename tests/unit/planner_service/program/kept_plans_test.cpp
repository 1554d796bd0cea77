// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/program/kept_plans.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

TEST(KeptPlans, AreTheFirstAndTheNewestHundred) {
  std::set<std::uint32_t> kept;
  for (std::uint32_t version = 1; version <= 500; ++version) {
    kept.insert(version);
    kept.erase(outdated_plan(version));
    const std::uint32_t newest = std::min(version, shell::kPlansKept + 1);
    EXPECT_EQ(kept.size(), newest) << version;
    EXPECT_TRUE(kept.contains(1));
    EXPECT_EQ(*std::next(kept.begin(), newest > 1 ? 1 : 0),
              version - newest + (newest > 1 ? 2 : 1));
  }
}

TEST(KeptPlans, HaveTheirVersionInTheirNames) {
  EXPECT_EQ(plan_file("/run", 7), "/run/plan-0007.json");
  EXPECT_EQ(plan_file("/run", 12345), "/run/plan-12345.json");
}

}  // namespace
}  // namespace swarm::planner
