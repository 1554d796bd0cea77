// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/plan/planning_record.hpp"

#include <string>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

TEST(PlanningRecord, ReadsBackWhatWasWritten) {
  Rng rng(1);
  for (int i = 0; i < 500; ++i) {
    PlanningRecord record{.method = "rover \"x\" \\ \n \xc3\xa9"};
    if (i % 3 != 0) record.density_cap_per_m2 = uniform(rng, 1e-9, 10);

    const auto read = planning_record_from_json(to_json(record));

    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(read->method, record.method);
    EXPECT_EQ(read->density_cap_per_m2, record.density_cap_per_m2);
  }
}

TEST(PlanningRecord, HasNoCapWhereNoneIsPositive) {
  for (const char* cap : {"null", "0", "-1", "\"2\"", "[2]", "1e999", "true"}) {
    const auto read = planning_record_from_json(
        std::string("{\"method\": \"crops\", \"density_cap_per_m2\": ") + cap + "}");

    if (read) {
      EXPECT_FALSE(read->density_cap_per_m2.has_value()) << cap;
    }
  }
  ASSERT_TRUE(planning_record_from_json("{\"method\": \"crops\"}").has_value());
}

TEST(PlanningRecord, IsNoneOfWhatIsNoRecord) {
  const std::string good = to_json({.method = "swarmprm", .density_cap_per_m2 = 2.05});
  // Cut anywhere but in the final white space.
  for (std::size_t length = 0; length < good.find_last_of('}'); ++length) {
    EXPECT_FALSE(planning_record_from_json(good.substr(0, length)).has_value()) << length;
  }
  for (const char* text : {"", "null", "7", "[]", "{}", "{\"method\": 7}", "\"method\"",
                           "{\"density_cap_per_m2\": 2}", "\xff\xfe"}) {
    EXPECT_FALSE(planning_record_from_json(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace swarm
