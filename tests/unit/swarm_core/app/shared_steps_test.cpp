// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/shared_steps.hpp"

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::shell {
namespace {

/// Its values follow from its number, so that a reader sees a mixture of two.
robot_log::Step step_of(std::uint32_t number) {
  return {.stamp = UtcTime(std::chrono::hours(400'000) + std::chrono::milliseconds(50) * number),
          .position_m = Vec2(0.5 * number, -1.5),
          .velocity_mps = Vec2(0.25, 0.125 * number),
          .lateness_us = -7,
          .mode = 3,
          .goal = 2,
          .neighbours = 300,
          .plan_version = number,
          .plan_time_s = 12.5F,
          .reference_x_m = 1.5F,
          .reference_y_m = 2.5F};
}

SharedSteps make_steps(RobotId first, std::uint32_t count) {
  return SharedSteps::make(first, count).value();
}

TEST(SharedSteps, KeepTheLastTwoOfEachRobot) {
  SharedSteps sut = make_steps(RobotId(40), 3);
  EXPECT_TRUE(sut.last(RobotId(41)).empty());

  sut.record(RobotId(41), step_of(1));
  EXPECT_EQ(sut.last(RobotId(41)).size(), 1U);
  for (std::uint32_t number = 2; number <= 11; ++number) sut.record(RobotId(41), step_of(number));

  const auto last = sut.last(RobotId(41));
  ASSERT_EQ(last.size(), 2U);
  EXPECT_EQ(last[0].plan_version, 10U);
  const robot_log::Step expected = step_of(11);
  EXPECT_EQ(last[1].stamp, expected.stamp);
  EXPECT_EQ(last[1].position_m, expected.position_m);
  EXPECT_EQ(last[1].velocity_mps, expected.velocity_mps);
  EXPECT_EQ(last[1].lateness_us, expected.lateness_us);
  EXPECT_EQ(last[1].mode, expected.mode);
  EXPECT_EQ(last[1].goal, expected.goal);
  EXPECT_EQ(last[1].neighbours, expected.neighbours);
  EXPECT_EQ(last[1].plan_time_s, expected.plan_time_s);
  EXPECT_EQ(last[1].reference_x_m, expected.reference_x_m);
  EXPECT_EQ(last[1].reference_y_m, expected.reference_y_m);
  EXPECT_TRUE(sut.last(RobotId(40)).empty());
  EXPECT_TRUE(sut.last(RobotId(42)).empty());
}

TEST(SharedSteps, HavePlacesForTheirRobotsAlone) {
  const SharedSteps sut = make_steps(RobotId(40), 3);

  EXPECT_TRUE(sut.has(RobotId(40)));
  EXPECT_TRUE(sut.has(RobotId(42)));
  EXPECT_FALSE(sut.has(RobotId(39)));
  EXPECT_FALSE(sut.has(RobotId(43)));
  EXPECT_FALSE(make_steps(RobotId(0), 0).has(RobotId(0))) << "all robots are on other hosts";
}

// What they exist for. The child is killed in the middle of a step as often as not.
TEST(SharedSteps, SurviveTheProcessThatMadeThem) {
  const SharedSteps sut = make_steps(RobotId(0), 2);
  const std::string path = sut.path();  // of this process
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    auto steps = SharedSteps::open(path);
    if (!steps) ::_exit(9);
    for (std::uint32_t number = 1; number < 1'000'000'000; ++number) {
      steps->record(RobotId(1), step_of(number));
      if (number % 64 == 0) ::usleep(50);  // so that some reads are not overtaken
      if (number == 1000 && ::write(ready[1], "x", 1) != 1) ::_exit(9);
    }
    ::_exit(0);
  }
  ::close(ready[1]);
  char byte = 0;
  const bool is_ready = ::read(ready[0], &byte, 1) == 1;
  ::close(ready[0]);
  int read = 0;
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  // While it writes in bursts as fast as it can, and overtakes some reads.
  while (read < 1000 && std::chrono::steady_clock::now() < limit) {
    for (const robot_log::Step& step : sut.last(RobotId(1))) {
      EXPECT_EQ(step.stamp, step_of(step.plan_version).stamp);
      EXPECT_EQ(step.position_m, step_of(step.plan_version).position_m);
      EXPECT_EQ(step.velocity_mps, step_of(step.plan_version).velocity_mps);
      ++read;
    }
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ASSERT_TRUE(is_ready);
  EXPECT_GE(read, 1000);

  const auto last = sut.last(RobotId(1));
  ASSERT_EQ(last.size(), 2U);
  EXPECT_GE(last[1].plan_version, 1000U);
  EXPECT_EQ(last[1].stamp, step_of(last[1].plan_version).stamp);
  EXPECT_EQ(last[1].stamp - last[0].stamp, std::chrono::milliseconds(50));
}

TEST(SharedSteps, AreContinuedByTheNextProcess) {
  const SharedSteps sut = make_steps(RobotId(0), 1);
  SharedSteps::open(sut.path()).value().record(RobotId(0), step_of(1));
  auto next = SharedSteps::open(sut.path());
  ASSERT_TRUE(next);
  ASSERT_EQ(next->last(RobotId(0)).size(), 1U);

  next->record(RobotId(0), step_of(2));

  EXPECT_EQ(sut.last(RobotId(0)).back().plan_version, 2U);
}

// A robot's process could write anything.
TEST(SharedSteps, LeaveOutWhatCannotBeAStep) {
  SharedSteps sut = make_steps(RobotId(0), 1);
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), 1e9, -1e300}) {
    robot_log::Step step = step_of(1);
    step.position_m.x() = wrong;
    sut.record(RobotId(0), step);
    step = step_of(2);
    step.velocity_mps.y() = wrong;
    sut.record(RobotId(0), step);

    EXPECT_TRUE(sut.last(RobotId(0)).empty()) << wrong;
  }

  sut.record(RobotId(0), step_of(3));
  EXPECT_EQ(sut.last(RobotId(0)).size(), 1U);
  robot_log::Step step = step_of(4);
  step.position_m.y() = 2e6;
  sut.record(RobotId(0), step);
  EXPECT_TRUE(sut.last(RobotId(0)).empty()) << "an older step is not the newest one";
}

TEST(SharedSteps, OpenNoOtherFile) {
  const ScratchFolder folder;
  const std::string file = folder.path() / "steps";
  EXPECT_EQ(SharedSteps::open(file).error().code, ErrorCode::kEnvironment) << "there is none";
  const SharedSteps steps = make_steps(RobotId(0), 1);
  std::filesystem::copy_file(steps.path(), file);

  const auto of_a_file = SharedSteps::open(file);  // that others can cut

  ASSERT_FALSE(of_a_file);
  EXPECT_EQ(of_a_file.error().code, ErrorCode::kBadInput);
  EXPECT_NE(::truncate(steps.path().c_str(), 0), 0) << "its size is sealed";
}

}  // namespace
}  // namespace swarm::shell
