// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Where the logs of a joined host end: the lines about them, and which of them do not grow.
#include "swarm_launcher/hosts/last_position.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_launcher/hosts/log_watch.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"

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
      R"({"last":7,"utc_ns":5,"position_m":[1,2],"command_mps":[0,0],"speed_mps":null,"dead":true})");
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
      {"dead", 1},
  };
  for (const auto& [key, value] : bad) {
    nlohmann::json line = good;
    line[key] = value;
    EXPECT_FALSE(parse_last_position(line)) << line;
    line.erase(key);
    EXPECT_FALSE(parse_last_position(line)) << line;
  }
}

class LogWatchTest : public testing::Test {
 protected:
  LogWatchTest() { std::filesystem::create_directories(folder_.path() / "blackbox"); }
  void grow(std::uint32_t robot) const {
    std::ofstream(robot_log::file_of(folder_.path(), RobotId(robot)), std::ios::app) << "x";
  }
  std::vector<RobotId> silent_at(int ms) {
    return sut_.step(SteadyTime(std::chrono::hours(1) + milliseconds(ms)));
  }

 private:
  ScratchFolder folder_;
  LogWatch sut_{folder_.path(), RobotId(5), 3};
};

TEST_F(LogWatchTest, FindsALogThatDoesNotGrowOnceUntilItGrows) {
  grow(5);
  grow(6);  // 7 has none
  EXPECT_TRUE(silent_at(0).empty());
  grow(5);
  EXPECT_TRUE(silent_at(1000).empty());

  EXPECT_EQ(silent_at(1250), std::vector{RobotId(6)});
  EXPECT_EQ(silent_at(2250), std::vector{RobotId(5)});
  EXPECT_TRUE(silent_at(9000).empty());
  grow(6);
  EXPECT_TRUE(silent_at(9250).empty());
  EXPECT_EQ(silent_at(10'500), std::vector{RobotId(6)});
}

TEST_F(LogWatchTest, LooksFourTimesASecond) {
  grow(5);
  EXPECT_TRUE(silent_at(0).empty());
  EXPECT_TRUE(silent_at(1100).empty());

  EXPECT_TRUE(silent_at(1300).empty()) << "0.2 s after the last look";
  EXPECT_EQ(silent_at(1350), std::vector{RobotId(5)});
}

}  // namespace
}  // namespace swarm::launcher
