// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The last steps of a joined host's robots: the lines about them, and which robots make none.
#include "swarm_launcher/hosts/last_position.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "swarm_core/app/shared_steps.hpp"
#include "swarm_launcher/hosts/step_watch.hpp"

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;

TEST(LastPosition, ComesBackAsItWas) {
  for (const std::optional<double> speed_mps : {std::optional<double>(), std::optional(0.25)}) {
    const LastPosition sent{.robot = RobotId(7),
                            .known = {.at = UtcTime(Duration(1'700'000'000'123'456'789)),
                                      .position_m = {1.5, -2.25},
                                      .command_mps = Vec2(0.5, 0.125),
                                      .speed_mps = speed_mps,
                                      .is_last = true}};

    const auto back = parse_last_position(nlohmann::json::parse(to_line(sent)));

    ASSERT_TRUE(back);
    EXPECT_EQ(back->robot, sent.robot);
    EXPECT_EQ(back->known.at, sent.known.at);
    EXPECT_EQ(back->known.position_m, sent.known.position_m);
    EXPECT_EQ(back->known.command_mps, sent.known.command_mps);
    EXPECT_EQ(back->known.speed_mps, sent.known.speed_mps);
    EXPECT_TRUE(back->known.is_last);
  }
}

TEST(LastPosition, OfAnotherFormIsRefused) {
  const nlohmann::json good = nlohmann::json::parse(
      R"({"last":7,"utc_ns":5,"position_m":[1,2],"command_mps":[0,0],"speed_mps":null,"final":true})");
  ASSERT_TRUE(parse_last_position(good));
  const std::vector<std::pair<const char*, nlohmann::json>> bad = {
      {"last", -1},
      {"last", 5'000'000'000},
      {"utc_ns", "now"},
      {"utc_ns", -1},
      {"utc_ns", 10'000'000'000'000'000'000U},
      {"position_m", {1e9, 0}},
      {"position_m", {1}},
      {"position_m", {1, "2"}},
      {"command_mps", nullptr},
      {"speed_mps", "fast"},
      {"final", 1},
  };
  for (const auto& [key, value] : bad) {
    nlohmann::json line = good;
    line[key] = value;
    EXPECT_FALSE(parse_last_position(line)) << line;
    line.erase(key);
    EXPECT_FALSE(parse_last_position(line)) << line;
  }
}

class StepWatchTest : public testing::Test {
 protected:
  void step(std::uint32_t robot) {
    utc_now_ += milliseconds(100);
    steps_.record(RobotId(robot), {.stamp = utc_now_});
  }
  /// Robots that have fallen silent, and the ids of those that are back as negative numbers.
  std::vector<int> changes_at(int ms) {
    std::vector<int> ids;
    for (const auto& change : sut_.step(SteadyTime(std::chrono::hours(1) + milliseconds(ms)))) {
      const auto id = static_cast<int>(change.robot.value());
      ids.push_back(change.is_silent ? id : -id);
    }
    return ids;
  }

  std::vector<int> hung_at(int ms) {
    std::vector<int> ids;
    for (const RobotId robot : sut_.hung(SteadyTime(std::chrono::hours(1) + milliseconds(ms)))) {
      ids.push_back(static_cast<int>(robot.value()));
    }
    return ids;
  }

 private:
  UtcTime utc_now_{std::chrono::hours(400'000)};
  shell::SharedSteps steps_ = shell::SharedSteps::make(RobotId(5), 3).value();
  StepWatch sut_{steps_, RobotId(5), 3, milliseconds(1250)};
};

using Ids = std::vector<int>;

TEST_F(StepWatchTest, FindsARobotWithoutStepsOnceUntilItMakesOne) {
  step(5);
  step(6);  // 7 has made none
  EXPECT_EQ(changes_at(0), Ids{});
  step(5);
  EXPECT_EQ(changes_at(1000), Ids{});

  EXPECT_EQ(changes_at(1250), Ids{6});
  EXPECT_EQ(changes_at(2250), Ids{5});
  EXPECT_EQ(changes_at(4000), Ids{});
  step(6);
  EXPECT_EQ(changes_at(4250), Ids{});
  EXPECT_EQ(changes_at(5500), Ids{6});
}

// A restarted process makes steps before its status arrives.
TEST_F(StepWatchTest, ReportsARobotThatHasMadeStepsAgainForFiveSeconds) {
  step(6);
  EXPECT_EQ(changes_at(0), Ids{});
  EXPECT_EQ(changes_at(1250), Ids{6});
  for (int ms = 2000; ms < 7000; ms += 500) {
    step(6);
    EXPECT_EQ(changes_at(ms), Ids{}) << ms;
  }
  step(6);
  EXPECT_EQ(changes_at(7000), Ids{-6});
  step(6);
  EXPECT_EQ(changes_at(7500), Ids{});
}

// Robots 5 to 7.
TEST_F(StepWatchTest, FindsThatARobotHangsAfterTenSeconds) {
  for (const std::uint32_t robot : {5U, 6U, 7U}) step(robot);
  changes_at(0);
  for (int ms = 500; ms <= 12'000; ms += 500) {
    step(5);
    step(7);
    changes_at(ms);
    EXPECT_EQ(hung_at(ms), ms < 10'000 ? Ids{} : Ids{6}) << ms;
  }
}

TEST_F(StepWatchTest, CountsAnewAfterTheHostWasSuspended) {
  for (const std::uint32_t robot : {5U, 6U, 7U}) step(robot);
  changes_at(0);
  changes_at(500);

  EXPECT_EQ(changes_at(60'000), Ids{});
  EXPECT_EQ(hung_at(60'000), Ids{});
}

TEST_F(StepWatchTest, LooksFourTimesASecond) {
  step(5);
  EXPECT_EQ(changes_at(0), Ids{});
  EXPECT_EQ(changes_at(1100), Ids{});

  EXPECT_EQ(changes_at(1300), Ids{}) << "0.2 s after the last look";
  EXPECT_EQ(changes_at(1350), Ids{5});
}

}  // namespace
}  // namespace swarm::launcher
