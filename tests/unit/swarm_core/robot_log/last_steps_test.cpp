// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <filesystem>

#include <gtest/gtest.h>

#include "swarm_core/robot_log/robot_log_file.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::robot_log {
namespace {

UtcTime second(int i) { return UtcTime(std::chrono::seconds(1'700'000'000 + i)); }

TEST(LastSteps, AreReadFromATimeOn) {
  const ScratchFolder folder;
  const auto file = folder.path() / "robot.mcap";
  auto writer = Writer::open(file);
  ASSERT_TRUE(writer.has_value());
  writer->append(Header{.robot = RobotId(0), .robots = 1, .radius_m = 0.2, .stamp = second(0)});
  for (int i = 0; i < 50; ++i) writer->append(Step{.stamp = second(i)});

  const auto all = last_steps(file);
  const auto recent = last_steps(file, second(47));
  const auto one = last_steps(file, second(49));
  const auto none = last_steps(file, second(50));

  ASSERT_TRUE(all && recent && one && none);
  ASSERT_EQ(all->size(), 2U);
  EXPECT_EQ(all->front().stamp, second(48));
  EXPECT_EQ(all->back().stamp, second(49));
  ASSERT_EQ(recent->size(), 2U);
  EXPECT_EQ(recent->front().stamp, second(48));
  EXPECT_EQ(one->size(), 1U);
  EXPECT_TRUE(none->empty());
}

TEST(LastSteps, OfARobotWithoutALogAreNone) {
  const ScratchFolder folder;
  EXPECT_TRUE(last_steps(folder.path() / "none.mcap")->empty());
}

// As on a disk that is gone: an exception would end the flight of the launcher, which looks here.
TEST(LastSteps, OfALogThatCannotBeLookedAtAreAnError) {
  const ScratchFolder folder;
  const auto file = folder.path() / "loop.mcap";
  std::filesystem::create_symlink(file, file);
  const auto steps = last_steps(file);
  ASSERT_FALSE(steps.has_value());
  EXPECT_EQ(steps.error().code, ErrorCode::kEnvironment);
}

}  // namespace
}  // namespace swarm::robot_log
