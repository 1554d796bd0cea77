// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Where the robots of a process begin.
#include "robot_agent/program/local_robot.hpp"

#include <chrono>
#include <filesystem>

#include <gtest/gtest.h>

#include "swarm_core/app/shared_steps.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::agent {
namespace {

constexpr std::uint64_t kSeed = 3;
constexpr RobotId kRobot(2);
const UtcTime kBegin(std::chrono::hours(400'000));

Mission standing_mission() {
  auto mission =
      load_mission(std::filesystem::path(SWARM_SOURCE_DIR) / "deploy/missions/small.yaml");
  EXPECT_TRUE(mission.has_value());
  return *std::move(mission);
}

class LocalRobotTest : public testing::Test {
 protected:
  static robot_log::Step step_at(const Vec2& position_m, int ms) {
    return {.stamp = kBegin + std::chrono::milliseconds(ms), .position_m = position_m};
  }
  void log(const robot_log::Step& step) const {
    auto writer = robot_log::Writer::open(robot_log::file_of(folder_.path(), kRobot));
    ASSERT_TRUE(writer);
    writer->append(robot_log::Header{.robot = kRobot, .robots = 12, .stamp = kBegin});
    writer->append(step);
  }
  LocalRobots make(shell::SharedSteps* steps) {
    auto made = make_local_robots(mission_, world_, builtin_robots(),
                                  {.files = files_,
                                   .steps = steps,
                                   .run_dir = folder_.path(),
                                   .first = kRobot,
                                   .count = 1,
                                   .seed = kSeed,
                                   .now = SteadyTime(std::chrono::hours(1)),
                                   .utc_now = kBegin});
    EXPECT_TRUE(made.has_value());
    return *std::move(made);
  }
  static Vec2 position_of(const LocalRobots& robots) {
    return robots.robots.front().driver->measure(SteadyTime(std::chrono::hours(1))).position_m;
  }

  const Mission mission_ = standing_mission();
  shell::SharedSteps steps_ = shell::SharedSteps::make(RobotId(0), mission_.robots.count).value();

 private:
  World world_{mission_.world};
  ScratchFolder folder_;
  shell::FileThread files_;
};

TEST_F(LocalRobotTest, BeginsWhereTheMissionPlacesIt) {
  const LocalRobots robots = make(&steps_);

  EXPECT_EQ(position_of(robots), place_robots(mission_, kSeed).value()[kRobot.value()]);
  EXPECT_FALSE(robots.any_is_underway);
}

TEST_F(LocalRobotTest, BeginsAtTheEndOfItsLogWhereNoMemoryIsShared) {
  log(step_at({20, 14}, 100));

  const LocalRobots robots = make(nullptr);

  EXPECT_EQ(position_of(robots), Vec2(20, 14));
  EXPECT_TRUE(robots.any_is_underway);
}

// A full disk has not taken the end of the log.
TEST_F(LocalRobotTest, BeginsAtItsLastStepThoughItsLogEndsEarlier) {
  log(step_at({20, 14}, 100));
  steps_.record(kRobot, step_at({24, 14}, 4100));

  EXPECT_EQ(position_of(make(&steps_)), Vec2(24, 14));
}

// Its process before was started by hand, and shared no steps.
TEST_F(LocalRobotTest, BeginsAtTheEndOfItsLogIfThatIsNewer) {
  steps_.record(kRobot, step_at({24, 14}, 100));
  log(step_at({20, 14}, 4100));

  EXPECT_EQ(position_of(make(&steps_)), Vec2(20, 14));
}

TEST_F(LocalRobotTest, SharesItsSteps) {
  LocalRobots robots = make(&steps_);

  robots.robots.front().log.append(step_at({20, 14}, 100));

  ASSERT_EQ(steps_.last(kRobot).size(), 1U);
  EXPECT_EQ(steps_.last(kRobot).front().position_m, Vec2(20, 14));
  EXPECT_TRUE(steps_.last(RobotId(1)).empty());
}

}  // namespace
}  // namespace swarm::agent
