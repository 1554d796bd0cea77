// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gate/refusal.hpp"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_link/wire_bounds.hpp"

namespace swarm::link {
namespace {

TEST(RefusalCounters, CountByReason) {
  RefusalCounters counters;
  counters.count(RefusalReason::kStale);
  counters.count(RefusalReason::kForged, 3);
  EXPECT_EQ(counters[RefusalReason::kStale], 1U);
  EXPECT_EQ(counters[RefusalReason::kForged], 3U);
  EXPECT_EQ(counters[RefusalReason::kSchema], 0U);
  EXPECT_EQ(counters.total(), 4U);
}

TEST(RefusalReason, HasANameOfItsOwn) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kRefusalReasons; ++i) {
    names.insert(to_string(static_cast<RefusalReason>(i)));
  }
  EXPECT_EQ(names.size(), kRefusalReasons);
  EXPECT_FALSE(names.contains("unknown"));
  EXPECT_LE(kRefusalReasons, kMaxRefusalReasons);
}

TEST(ReportNew, ReportsEachRefusalOnce) {
  RefusalCounters refused, reported;
  std::vector<std::string> reports;
  const auto report = [&] {
    report_new(refused, reported, [&](RefusalReason reason, std::uint32_t times) {
      reports.push_back(std::to_string(times) + " " + std::string(to_string(reason)));
    });
  };

  report();
  EXPECT_TRUE(reports.empty());
  refused.count(RefusalReason::kStale, 2);
  refused.count(RefusalReason::kForged);
  report();
  report();
  refused.count(RefusalReason::kStale);
  report();

  EXPECT_EQ(reports, (std::vector<std::string>{"2 stale", "1 forged", "1 stale"}));
}

}  // namespace
}  // namespace swarm::link
