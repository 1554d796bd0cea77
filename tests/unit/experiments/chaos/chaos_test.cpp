// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "experiments/chaos/fault_schedule.hpp"
#include "experiments/chaos/flight_result.hpp"
#include "swarm_core/mission/link_faults.hpp"

namespace swarm::launcher {
namespace {

constexpr ChaosLimits kLimits{.agents = 60};

TEST(FaultSchedule, IsTheSameForTheSameSeed) {
  Rng first(5), second(5), other(6);
  const auto a = draw_faults(kLimits, first), b = draw_faults(kLimits, second);
  const auto same = [](const Fault& x, const Fault& y) {
    return x.at == y.at && x.kind == y.kind && x.agent == y.agent && x.lasts == y.lasts;
  };
  EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end(), same));
  const auto c = draw_faults(kLimits, other);
  EXPECT_FALSE(std::equal(a.begin(), a.end(), c.begin(), c.end(), same));
}

TEST(FaultSchedule, KeepsItsLimitsAndUsesEveryKind) {
  std::set<FaultKind> kinds;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Rng rng(seed);
    std::set<std::uint32_t> agents;
    std::uint32_t kills = 0;
    Duration before{};
    for (const Fault& fault : draw_faults(kLimits, rng)) {
      EXPECT_GE(fault.at, before);
      EXPECT_LT(fault.at, from_seconds(kLimits.until_s));
      before = fault.at;
      kinds.insert(fault.kind);
      kills += fault.kind == FaultKind::kKillAgent ? 1 : 0;
      if (fault.kind != FaultKind::kKillAgent && fault.kind != FaultKind::kFreezeAgent) continue;
      EXPECT_LT(fault.agent, kLimits.agents);
      EXPECT_TRUE(agents.insert(fault.agent).second) << "hit twice";
    }
    EXPECT_LE(kills, 3U);
  }
  EXPECT_EQ(kinds.size(), 7U);
}

TEST(FaultSchedule, WithoutAgentsHasOtherFaults) {
  Rng rng(3);
  for (const Fault& fault : draw_faults({.agents = 0}, rng)) {
    EXPECT_NE(fault.kind, FaultKind::kKillAgent);
    EXPECT_NE(fault.kind, FaultKind::kFreezeAgent);
  }
}

TEST(FaultSchedule, DrawsNetworksThatTheProgramsUnderstand) {
  Rng rng(4);
  std::set<bool> perfect;
  for (int i = 0; i < 30; ++i) {
    const std::string network = draw_network(rng);
    EXPECT_TRUE(parse_link_faults(network)) << network;
    perfect.insert(network.empty());
  }
  EXPECT_EQ(perfect.size(), 2U);
}

nlohmann::json summary() {
  return {{"robots", 60},
          {"arrived", 60},
          {"lost", nlohmann::json::array()},
          {"collisions_robot", 0},
          {"collisions_obstacle", 0},
          {"collisions_fallen", 0},
          {"outcome", "completed"}};
}

TEST(FlightVerdict, IsGoodWhenAllArrive) {
  EXPECT_TRUE(judge_flight(summary(), {}).failures.empty());
}

TEST(FlightVerdict, ExplainsALostRobotByTheFaultThatKilledIt) {
  auto flown = summary();
  flown["arrived"] = 59;
  flown["lost"] = {7};
  EXPECT_TRUE(judge_flight(flown, {{.kind = FaultKind::kKillAgent, .agent = 7}}).failures.empty());
  EXPECT_EQ(judge_flight(flown, {{.kind = FaultKind::kFreezeAgent, .agent = 7}}).failures.size(),
            1U);
  EXPECT_EQ(judge_flight(flown, {{.kind = FaultKind::kKillAgent, .agent = 8}}).failures.size(), 1U);
}

TEST(FlightVerdict, NamesContactsMissingRobotsAndAMissingSummary) {
  auto touched = summary();
  touched["collisions_fallen"] = 2;
  EXPECT_EQ(judge_flight(touched, {}).contacts, 2U);
  EXPECT_EQ(judge_flight(touched, {}).failures.size(), 1U);
  auto late = summary();
  late["arrived"] = 58;
  EXPECT_EQ(judge_flight(late, {}).failures.size(), 1U);
  EXPECT_EQ(judge_flight(nlohmann::json(), {}).failures.size(), 1U);
  EXPECT_EQ(judge_flight({{"collisions_robot", nullptr}}, {}).failures.size(), 1U);
}

}  // namespace
}  // namespace swarm::launcher
