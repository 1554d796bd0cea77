// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What people read of a run: the stage, the outcome, lists of robots.
#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_launcher/supervision/progress.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::launcher {
namespace {

SteadyTime at_s(double s) { return SteadyTime(from_seconds(1000.0 + s)); }

TEST(SupervisorHeadline, NamesEveryStage) {
  const auto report_both = [](Supervisor& sut) {
    for (const std::uint32_t i : {0U, 1U}) {
      sut.on_status(RobotId(i), {true, true, RobotMode::kWaiting});
    }
  };
  Supervisor sut({.robots = 2, .launcher = {.starts_per_s = 1000.0}, .script = {}}, at_s(0));
  EXPECT_EQ(headline_of(sut), "starting 3 processes");
  sut.step(at_s(1));
  EXPECT_EQ(headline_of(sut), "waiting for all robots to be received");
  report_both(sut);
  sut.step(at_s(2));
  EXPECT_EQ(headline_of(sut), "mission running");
  sut.on_command(CommandKind::kPause, at_s(3));
  sut.step(at_s(3));
  EXPECT_EQ(headline_of(sut), "mission paused");
  sut.on_interrupt();
  sut.step(at_s(4));
  EXPECT_EQ(headline_of(sut), "ending all processes");
  for (std::uint32_t i = 0; i < 3; ++i) sut.on_exit(ProcessIndex(i), {}, at_s(5));
  sut.step(at_s(5));
  EXPECT_EQ(headline_of(sut), "all processes ended");
}

TEST(OutcomeNames, AreDistinctAndInSnakeCase) {
  std::set<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(Outcome::kAllLost); ++i) {
    const std::string_view name = to_string(static_cast<Outcome>(i));
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string_view::npos);
    EXPECT_TRUE(names.insert(name).second) << name;
  }
}

// Read back: the ranges name exactly the robots, and the rest is counted.
TEST(Describe, NamesOrCountsEveryRobot) {
  Rng rng(5);
  EXPECT_EQ(describe(std::vector<RobotId>{}), "");
  for (int round = 0; round < 500; ++round) {
    std::vector<RobotId> robots;
    const std::uint64_t sparse = 1 + rng() % 5;
    for (std::uint32_t i = 0; i < 100; ++i) {
      if (rng() % sparse == 0) robots.emplace_back(i);
    }
    std::string text = describe(robots);
    std::size_t more = 0;
    if (const auto end = text.find(" and "); end != std::string::npos) {
      more = std::stoul(text.substr(end + 5));
      text.resize(end);
    }
    std::vector<RobotId> named;
    std::istringstream in(text);
    for (std::string range; std::getline(in, range, ',');) {
      const auto dash = range.find('-');
      const auto last = std::stoul(dash == std::string::npos ? range : range.substr(dash + 1));
      for (auto id = std::stoul(range); id <= last; ++id) {
        named.emplace_back(static_cast<std::uint32_t>(id));
      }
    }
    ASSERT_EQ(named.size() + more, robots.size()) << text;
    ASSERT_TRUE(std::equal(named.begin(), named.end(), robots.begin())) << text;
  }
}

}  // namespace
}  // namespace swarm::launcher
