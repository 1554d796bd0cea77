// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/stepped_clock.hpp"

#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace swarm::launcher {
namespace {

/// The wall clock of a process that is started now, and whether ours was on both sides of it after
/// subtracting `offset_s`.
bool child_is_off_by(std::int64_t offset_s, const std::filesystem::path& file) {
  const std::time_t before = std::time(nullptr);
  if (std::system(("date +%s >" + file.string()).c_str()) != 0) return false;
  const std::time_t after = std::time(nullptr);
  std::int64_t theirs = 0;
  std::ifstream(file) >> theirs;
  return before <= theirs - offset_s && theirs - offset_s <= after;
}

TEST(SteppedClock, IsTheWallClockOfChildrenWhileItExists) {
  const auto folder = std::filesystem::temp_directory_path();
  const std::string name = "swarmflow-clock-" + std::to_string(::getpid());
  const auto offset = folder / name, out = folder / (name + ".out");
  {
    const auto clock = SteppedClock::make(offset);
    if (!clock) GTEST_SKIP() << clock.error().message;
    EXPECT_TRUE(child_is_off_by(0, out));
    (*clock)->step(3600);
    EXPECT_TRUE(child_is_off_by(3600, out));
    (*clock)->step(-3660);
    EXPECT_TRUE(child_is_off_by(-60, out)) << "steps add up";
  }
  EXPECT_TRUE(child_is_off_by(0, out));
  EXPECT_FALSE(std::filesystem::exists(offset));
  std::filesystem::remove(out);
}

}  // namespace
}  // namespace swarm::launcher
