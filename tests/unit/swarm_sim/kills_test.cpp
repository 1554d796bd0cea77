// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/kills.hpp"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

/// A row of robots, a metre apart.
std::vector<Candidate> row(std::uint32_t robots) {
  std::vector<Candidate> candidates;
  for (std::uint32_t i = 0; i < robots; ++i) candidates.push_back({RobotId(i), {1.0 * i, 0.5}});
  return candidates;
}

TEST(ParseKill, ReadsNumbersIdsAndBoxes) {
  const auto number = parse_kill("10@60");
  ASSERT_TRUE(number.has_value()) << number.error().message;
  EXPECT_EQ(number->count, 10U);
  EXPECT_EQ(number->at_s, 60.0);
  EXPECT_FALSE(number->in_m.has_value());

  const auto ids = parse_kill("ids:3,7@6.5");
  ASSERT_TRUE(ids.has_value()) << ids.error().message;
  EXPECT_EQ(ids->robots, std::vector({RobotId(3), RobotId(7)}));
  EXPECT_EQ(ids->at_s, 6.5);

  const auto boxed = parse_kill("2@60,in=-1:0:4.5:2");
  ASSERT_TRUE(boxed.has_value()) << boxed.error().message;
  EXPECT_EQ(boxed->in_m->min_m, Vec2(-1, 0));
  EXPECT_EQ(boxed->in_m->max_m, Vec2(4.5, 2));
}

TEST(ParseKill, ReportsHowItIsWritten) {
  for (const char* bad : {"", "10", "@60", "10@", "10@-1", "10@x", "10@nan", "0@60", "-3@60",
                          "ids:@60", "ids:3,x@60", "ids:3@60,in=0:0:1:1", "10@60,in=0:0:1",
                          "10@60,in=0:0:1:1:2", "10@60,in=2:0:1:1", "10@60,at=0:0:1:1", "1.5@60"}) {
    const auto kill = parse_kill(bad);
    ASSERT_FALSE(kill.has_value()) << bad;
    EXPECT_NE(kill.error().message.find("10@60"), std::string::npos) << bad;
  }
}

// A list or a box that goes on after its last part is a typing error, not a shorter one.
TEST(ParseKill, RefusesSeparatorsWithNothingBehindThem) {
  for (const char* bad : {"10@60,", "ids:3@60,", "ids:3,@60", "ids:,3@60", "ids:3,,7@60",
                          "10@60,in=0:0:1:1:", "10@60,in=:0:0:1:1", "10@60,in="}) {
    const auto kill = parse_kill(bad);
    ASSERT_FALSE(kill.has_value()) << bad;
    EXPECT_EQ(kill.error().code, ErrorCode::kBadInput);
    EXPECT_EQ(kill.error().message, "--kill: '" + std::string(bad) +
                                        "'; write it like 10@60 or ids:3,7@60 or "
                                        "10@60,in=90:40:110:60 (the robots inside x0:y0:x1:y1)");
  }
}

TEST(ParseKill, ReadsNumbersUpToTheirLimits) {
  EXPECT_EQ(parse_kill("4294967295@0").value().count, 4294967295U);
  EXPECT_FALSE(parse_kill("4294967296@0").has_value());
  EXPECT_EQ(parse_kill("ids:4294967295@1e3").value().robots.at(0), RobotId(4294967295U));
  EXPECT_EQ(parse_kill("1@1e3").value().at_s, 1000.0);
  for (const char* bad : {"ids:4294967296@1", "1@1e999", "1@inf", "+1@1", "1@+1", " 1@1", "1@1 ",
                          "1@60@61", "0x10@1", "1@1,in=0:0:inf:1", "1@1,in=0:0:0:1"}) {
    EXPECT_FALSE(parse_kill(bad).has_value()) << bad;
  }
}

// Which others may die changes whether a robot is among the chosen, but not its rank.
TEST(ChooseKilled, RanksEachRobotByItselfAndTheSeed) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto all = choose({.count = 8}, row(20), seed);
    std::vector<Candidate> some = row(20);
    std::erase_if(some, [](const Candidate& c) { return c.robot.value() % 3 == 0; });
    const auto of_some = choose({.count = 8}, some, seed);
    for (const RobotId robot : all) {
      if (robot.value() % 3 == 0) continue;
      EXPECT_NE(std::find(of_some.begin(), of_some.end(), robot), of_some.end());
    }
  }
}

TEST(ChooseKilled, TakesAllWhereThereAreFewer) {
  EXPECT_EQ(choose({.count = 9}, row(3), 1), std::vector({RobotId(0), RobotId(1), RobotId(2)}));
  EXPECT_TRUE(choose({.count = 9}, {}, 1).empty());
  EXPECT_TRUE(choose({.robots = {RobotId(1)}}, {}, 1).empty());
}

TEST(ChooseKilled, DrawsBySeedAndEachRobotAtMostOnce) {
  const auto living = row(100);
  const auto one = choose({.count = 10}, living, 1);
  EXPECT_EQ(std::set(one.begin(), one.end()).size(), 10U);
  EXPECT_TRUE(std::is_sorted(one.begin(), one.end()));
  EXPECT_EQ(choose({.count = 10}, living, 1), one);
  EXPECT_NE(choose({.count = 10}, living, 2), one);
}

TEST(ChooseKilled, DrawsEveryRobotAboutAsOften) {
  std::vector<int> often(20);
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    for (const RobotId robot : choose({.count = 5}, row(20), seed)) ++often[robot.value()];
  }
  // 500 each; five standard deviations of a binomial are 97.
  for (const int times : often) EXPECT_NEAR(times, 500, 97);
}

TEST(ChooseKilled, ChoosesInsideTheBoxOnly) {
  const Kill kill{.count = 3, .in_m = Box{{2.5, 0}, {7.5, 1}}};
  for (const RobotId robot : choose(kill, row(20), 5)) {
    EXPECT_GE(robot.value(), 3U);
    EXPECT_LE(robot.value(), 7U);
  }
  EXPECT_EQ(choose(kill, row(5), 5), std::vector({RobotId(3), RobotId(4)})) << "there are but two";
}

TEST(ChooseKilled, TakesTheIdsThatAreStillAlive) {
  EXPECT_EQ(choose({.robots = {RobotId(4), RobotId(1), RobotId(30)}}, row(20), 5),
            std::vector({RobotId(1), RobotId(4)}));
}

}  // namespace
}  // namespace swarm::launcher
