// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/mission_watch.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

constexpr Duration kSilence = std::chrono::seconds(2);

TEST(MissionWatch, FollowsTheCommandsInOrder) {
  MissionWatch sut(kSilence);

  sut.on_command(CommandKind::kStart);
  EXPECT_EQ(sut.phase(), MissionPhase::kRunning);
  sut.on_command(CommandKind::kPause);
  EXPECT_EQ(sut.phase(), MissionPhase::kPaused);
  sut.on_command(CommandKind::kResume);
  EXPECT_EQ(sut.phase(), MissionPhase::kRunning);
}

TEST(MissionWatch, ObeysAStopAndNothingAfterIt) {
  MissionWatch sut(kSilence);
  sut.on_command(CommandKind::kStart);

  sut.on_command(CommandKind::kStop);
  sut.on_command(CommandKind::kStop);
  sut.on_command(CommandKind::kStart);
  sut.on_command(CommandKind::kResume);

  EXPECT_EQ(sut.phase(), MissionPhase::kStopped);
}

TEST(MissionWatch, DetectsMissingHeartbeats) {
  MissionWatch sut(kSilence);
  const SteadyTime t0{std::chrono::seconds(100)};
  EXPECT_FALSE(sut.planner_alive(t0));

  sut.on_heartbeat(t0);

  EXPECT_TRUE(sut.planner_alive(t0 + kSilence));
  EXPECT_FALSE(sut.planner_alive(t0 + kSilence + Duration(1)));
}

TEST(MissionWatch, WaitsForNeighbourUpdatesAfterHeartbeatsResume) {
  constexpr Duration kResumeDelay = std::chrono::milliseconds(700);
  MissionWatch sut(kSilence, kResumeDelay);
  const SteadyTime t0{std::chrono::seconds(100)};
  sut.on_heartbeat(t0);
  sut.on_heartbeat(t0 + kResumeDelay);
  EXPECT_TRUE(sut.planner_alive(t0 + kResumeDelay));

  const SteadyTime back = t0 + kResumeDelay + 2 * kSilence;
  sut.on_heartbeat(back);
  EXPECT_FALSE(sut.planner_alive(back));
  sut.on_heartbeat(back + kResumeDelay / 2);
  EXPECT_FALSE(sut.planner_alive(back + kResumeDelay / 2));
  sut.on_heartbeat(back + kResumeDelay);
  EXPECT_TRUE(sut.planner_alive(back + kResumeDelay));
}

}  // namespace
}  // namespace swarm::agent
