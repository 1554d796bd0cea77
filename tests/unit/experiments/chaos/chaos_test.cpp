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
#include "experiments/chaos/flight_setup.hpp"
#include "swarm_core/mission/link_faults.hpp"

namespace swarm::launcher {
namespace {

constexpr ChaosLimits kLimits{.agents = 60, .gateway = true, .two_hosts = true};

TEST(FaultSchedule, IsTheSameForTheSameSeed) {
  Rng first(5), second(5), other(6);
  const auto a = draw_faults(kLimits, first), b = draw_faults(kLimits, second);
  const auto same = [](const Fault& x, const Fault& y) {
    return x.at == y.at && x.kind == y.kind && x.agent == y.agent && x.lasts == y.lasts &&
           x.step_s == y.step_s;
  };
  EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end(), same));
  const auto c = draw_faults(kLimits, other);
  EXPECT_FALSE(std::equal(a.begin(), a.end(), c.begin(), c.end(), same));
}

bool is_for_good(FaultKind kind) {
  return loses_robots(kind) || kind == FaultKind::kKillPlanner || kind == FaultKind::kHangPlanner ||
         kind == FaultKind::kKillGateway || kind == FaultKind::kAddObstacle;
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
      kills += loses_robots(fault.kind) ? 1 : 0;
      EXPECT_EQ(fault.lasts == Duration::zero(), is_for_good(fault.kind));
      EXPECT_NE(fault.step_s, 0);
      if (!loses_robots(fault.kind) && fault.kind != FaultKind::kFreezeAgent) continue;
      EXPECT_LT(fault.agent, kLimits.agents);
      EXPECT_TRUE(agents.insert(fault.agent).second) << "hit twice";
    }
    EXPECT_LE(kills, 3U);
  }
  EXPECT_EQ(kinds.size(), kFaultKinds);
}

TEST(FaultSchedule, HitsOnlyWhatTheFlightHas) {
  Rng rng(3);
  for (int i = 0; i < 50; ++i) {
    for (const Fault& fault : draw_faults({.agents = 0}, rng)) {
      EXPECT_FALSE(loses_robots(fault.kind));
      EXPECT_NE(fault.kind, FaultKind::kFreezeAgent);
      EXPECT_NE(fault.kind, FaultKind::kKillGateway);
      EXPECT_NE(fault.kind, FaultKind::kFreezeGateway);
      EXPECT_NE(fault.kind, FaultKind::kCutHosts);
    }
  }
}

TEST(FlightSetup, DrawsNetworksThatTheProgramsUnderstand) {
  Rng rng(4);
  std::set<bool> perfect, some_robots, gateway, two_hosts;
  for (int i = 0; i < 60; ++i) {
    const FlightSetup setup = draw_setup(60, rng);
    const auto faults = parse_link_faults(setup.network);
    ASSERT_TRUE(faults) << setup.network;
    EXPECT_TRUE(faults->at_planner() || faults->last_robot < 60U) << setup.network;
    perfect.insert(setup.network.empty());
    some_robots.insert(!faults->at_planner());
    gateway.insert(setup.gateway);
    two_hosts.insert(setup.two_hosts);
    EXPECT_FALSE(setup.gateway && setup.two_hosts);
  }
  for (const auto& seen : {perfect, some_robots, gateway, two_hosts}) EXPECT_EQ(seen.size(), 2U);
}

TEST(FlightSetup, OfOneRobotIsPlain) {
  Rng rng(5);
  for (int i = 0; i < 30; ++i) {
    const FlightSetup setup = draw_setup(1, rng);
    EXPECT_TRUE(parse_link_faults(setup.network)) << setup.network;
    EXPECT_FALSE(setup.gateway || setup.two_hosts);
  }
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

TEST(FlightVerdict, ExplainsALostRobotByTheFaultThatTookIt) {
  auto flown = summary();
  flown["arrived"] = 59;
  flown["lost"] = {7};
  const auto judge = [&](FaultKind kind, std::uint32_t agent) {
    return judge_flight(flown, {{.at = from_seconds(12.25), .kind = kind, .agent = agent}});
  };
  EXPECT_TRUE(judge(FaultKind::kKillAgent, 7).failures.empty());
  ASSERT_EQ(judge(FaultKind::kHangAgent, 7).lost.size(), 1U);
  EXPECT_EQ(judge(FaultKind::kHangAgent, 7).lost.front().robot, 7U);
  EXPECT_EQ(judge(FaultKind::kHangAgent, 7).lost.front().why, "hang-agent at 12.2 s");
  EXPECT_EQ(judge(FaultKind::kFreezeAgent, 7).failures.size(), 1U);
  EXPECT_EQ(judge(FaultKind::kFreezeAgent, 7).lost.front().why, "");
  EXPECT_EQ(judge(FaultKind::kKillAgent, 8).failures.size(), 1U);
}

TEST(FlightVerdict, AcceptsMissingRecordsOnlyOfAFullDisk) {
  auto flown = summary();
  flown["missing"] = {"3 records of robot logs"};
  EXPECT_EQ(judge_flight(flown, {}).failures.size(), 1U);
  EXPECT_TRUE(judge_flight(flown, {{.kind = FaultKind::kFillDisk}}).failures.empty());
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
