// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Commands and scenes that robots follow although the launcher has not published them.
#include <limits>
#include <vector>

#include "tests/unit/swarm_launcher/flight/flight_bench.hpp"

namespace swarm::launcher {
namespace {

constexpr std::uint64_t kAhead_ns = 9'000'000'000;  // robots accept ids up to 10 s ahead

class FlightLoopForeign : public FlightBench {
 protected:
  void start() {
    ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
    run_for(seconds(1));  // the robots have obeyed the start
  }
  std::uint64_t forged_id() const {
    return static_cast<std::uint64_t>(now.utc.time_since_epoch().count()) + kAhead_ns;
  }
  void follow_forged(RobotMode mode) {
    const std::uint64_t id = forged_id();
    for (FakeRobot& robot : robots) {
      robot.command_id = id;
      robot.mode = mode;
    }
  }
};

TEST_F(FlightLoopForeign, ForgedPauseIsOverruledAndTheNextCommandsAreObeyed) {
  start();
  EXPECT_FALSE(is_logged("command-foreign"));
  const std::uint64_t forged = forged_id();
  follow_forged(RobotMode::kHolding);

  run_for(seconds(1));

  EXPECT_TRUE(is_logged("command-foreign"));
  ASSERT_FALSE(commands.empty());
  EXPECT_EQ(commands.back().kind, CommandKind::kResume);
  EXPECT_GT(commands.back().command_id, forged);
  EXPECT_EQ(robots[0].mode, RobotMode::kMoving);
  const std::size_t before = commands.size();
  run_for(seconds(5));
  EXPECT_EQ(commands.size(), before) << "once";

  requests.send("pause");
  run_for(milliseconds(100));
  EXPECT_EQ(commands.back().kind, CommandKind::kPause);
  EXPECT_GT(commands.back().command_id, forged);
}

TEST_F(FlightLoopForeign, ForgedResumeIsOverruledInAPause) {
  start();
  requests.send("pause");
  run_for(milliseconds(100));
  ASSERT_EQ(loop->supervisor().phase(), MissionPhase::kPaused);
  follow_forged(RobotMode::kMoving);

  run_for(seconds(1));

  EXPECT_EQ(commands.back().kind, CommandKind::kPause);
  EXPECT_EQ(robots[0].mode, RobotMode::kHolding);
}

TEST_F(FlightLoopForeign, FloodOfForgedCommandsMakesTwoOfOursPerSecond) {
  start();
  const std::size_t before = commands.size();
  for (int i = 0; i < 50; ++i) {
    follow_forged(RobotMode::kHolding);
    run_for(milliseconds(100));
  }
  EXPECT_GT(commands.size(), before);
  EXPECT_LE(commands.size(), before + 12);
}

TEST_F(FlightLoopForeign, ForgedStatusWithTheLargestIdChangesNothing) {
  start();
  const std::size_t before = commands.size();
  for (FakeRobot& robot : robots) robot.command_id = std::numeric_limits<std::uint64_t>::max();
  run_for(seconds(2));
  EXPECT_EQ(commands.size(), before);
}

TEST_F(FlightLoopForeign, StopOfAnotherSenderIsNotOverruled) {
  start();
  const std::size_t before = commands.size();
  follow_forged(RobotMode::kStopped);
  run_for(seconds(2));
  EXPECT_EQ(commands.size(), before);
}

TEST_F(FlightLoopForeign, ForgedSceneIsOverruledByTheSameSceneWithANewerVersion) {
  start();
  std::vector<link::SceneMessage> scenes;
  others.scenes->take(scenes);
  const std::uint64_t forged = forged_id();
  for (FakeRobot& robot : robots) robot.scene_version = forged;

  run_for(seconds(1));

  EXPECT_TRUE(is_logged("scene-foreign"));
  scenes.clear();
  others.scenes->take(scenes);
  ASSERT_EQ(scenes.size(), 1U);
  EXPECT_GT(scenes[0].version, forged);
  EXPECT_EQ(scene->scene().risk_alpha, options.mission.planner.risk_alpha);
  run_for(seconds(3));
  scenes.clear();
  others.scenes->take(scenes);
  EXPECT_TRUE(scenes.empty()) << "once";
}

}  // namespace
}  // namespace swarm::launcher
