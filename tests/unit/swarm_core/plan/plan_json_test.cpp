// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/plan/plan_json.hpp"

#include <string>

#include <gtest/gtest.h>

namespace swarm {
namespace {

FlowPlan some_plan() {
  // 1/3 and 0.1 have no finite binary expansion, so they test whether all digits are written.
  const Gaussian a = Gaussian::from_parameters({0.1, 1.0 / 3.0}, 1.7, 2.3, 0.3);
  const Gaussian b = Gaussian::from_parameters({7.0 / 3.0, -4.2}, 0.9, 1.1, -0.55);
  return FlowPlan::make({{a, MissionTime(0), 1.0}, {b, MissionTime(1.0 / 7.0), 1.0}}, {{0, 1, 1.0}})
      .value();
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

std::string refusal(const std::string& text) {
  const auto plan = plan_from_json(text);
  EXPECT_FALSE(plan.has_value()) << text;
  return plan ? "" : plan.error().message;
}

TEST(PlanJson, ReadsBackBitByBit) {
  const FlowPlan plan = some_plan();

  const auto again = plan_from_json(to_json(plan));

  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->digest(), plan.digest());
}

TEST(PlanJson, NamesWhatItRefuses) {
  const std::string text = to_json(some_plan());

  EXPECT_NE(refusal("{").find("JSON"), std::string::npos);
  EXPECT_NE(refusal("").find("JSON"), std::string::npos);
  EXPECT_NE(refusal("[]").find("object"), std::string::npos);
  EXPECT_NE(refusal("{\"nodes\": []}").find("legs"), std::string::npos);
  EXPECT_NE(refusal("{\"nodes\": 3, \"legs\": []}").find("nodes"), std::string::npos);
  EXPECT_NE(refusal(replaced(text, "\"mass\": 1.0", "\"mass\": \"1\"")).find("legs[0].mass"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(text, "\"from\": 0", "\"from\": -1")).find("legs[0].from"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(text, "\"from\": 0", "\"from\": 0.5")).find("legs[0].from"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(text, "\"from\": 0", "\"from\": 4294967296")).find("legs[0].from"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(text, "\"time_s\"", "\"time\"")).find("time_s"), std::string::npos);
  EXPECT_NE(refusal(replaced(text, "\"from\"", "\"extra\": 1, \"from\"")).find("extra"),
            std::string::npos);
}

TEST(PlanJson, PassesOnWhatThePlanRefuses) {
  const std::string text = to_json(some_plan());

  EXPECT_NE(refusal(replaced(text, "\"to\": 1", "\"to\": 2")).find("leg 0"), std::string::npos);
  EXPECT_NE(refusal(replaced(text, "\"to\": 1", "\"to\": 0")).find("forward"), std::string::npos);
}

}  // namespace
}  // namespace swarm
