// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/late_robots.hpp"

#include <chrono>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;

SteadyTime at(int ms) { return SteadyTime(std::chrono::hours(1) + milliseconds(ms)); }

/// Those in the beat that is sent at this time.
std::vector<link::LateRobot> listed(LateRobots& sut, int ms) {
  link::LauncherBeat beat;
  sut.list(at(ms), beat);
  return {beat.late().begin(), beat.late().end()};
}

TEST(LateRobots, AreThoseWhoseNextStatusIsLate) {
  LateRobots sut(3, 2.0);  // two statuses a second
  sut.on_status(RobotId(1), {4.0, 2.0}, at(0), at(30));

  EXPECT_TRUE(listed(sut, 700).empty()) << "0.2 s later than the next one";
  ASSERT_EQ(listed(sut, 701).size(), 1U);
  EXPECT_EQ(listed(sut, 720)[0],
            (link::LateRobot{.robot = 1, .age_ms = 720, .x_m = 4.0, .y_m = 2.0}));

  sut.on_status(RobotId(1), {5.0, 2.0}, at(770), at(800));
  EXPECT_TRUE(listed(sut, 800).empty());
}

TEST(LateRobots, AreNotThoseWithoutAnyStatus) {
  LateRobots sut(3, 1.0);
  EXPECT_TRUE(listed(sut, 100'000).empty());
}

// By then the scene has had its body for three seconds.
TEST(LateRobots, AreLateUntilTheirBodiesAreObstacles) {
  LateRobots sut(3, 1.0);
  sut.on_status(RobotId(1), {4.0, 2.0}, at(0), at(0));
  for (int ms = 0; ms <= 6000; ms += 500) {
    EXPECT_EQ(listed(sut, ms).size(), ms > 1250 ? 1U : 0U) << ms;
  }
  EXPECT_TRUE(listed(sut, 6001).empty());
}

TEST(LateRobots, AreListedInTurnsWhereABeatHasNoRoomForAll) {
  constexpr std::uint32_t kRobots = 2 * link::LauncherBeat::kMaxLate + 5;
  LateRobots sut(kRobots, 1.0);
  for (std::uint32_t i = 0; i < kRobots; ++i) sut.on_status(RobotId(i), {1.0, 1.0}, at(0), at(0));
  std::set<std::uint32_t> seen;
  for (int ms = 1500; ms <= 2500; ms += 500) {
    link::LauncherBeat beat;
    sut.list(at(ms), beat);
    EXPECT_FALSE(beat.lists_all_late);
    for (const link::LateRobot& late : beat.late()) seen.insert(late.robot);
  }
  EXPECT_EQ(seen.size(), kRobots);
}

// Statuses that arrived while the launcher was suspended may not have been read yet.
TEST(LateRobots, AreNotStatedRightAfterASuspension) {
  LateRobots sut(3, 1.0);
  sut.on_status(RobotId(1), {4.0, 2.0}, at(0), at(0));
  sut.on_status(RobotId(2), {4.0, 3.0}, at(0), at(0));
  EXPECT_TRUE(listed(sut, 500).empty());

  link::LauncherBeat beat;
  sut.list(at(9000), beat);
  EXPECT_TRUE(beat.late().empty());
  EXPECT_FALSE(beat.lists_all_late);

  sut.on_status(RobotId(2), {4.0, 3.0}, at(9900), at(9900));
  for (int ms = 9500; ms < 10'250; ms += 500) EXPECT_TRUE(listed(sut, ms).empty());
  ASSERT_EQ(listed(sut, 10'300).size(), 1U) << "silent since the suspension, or before";
  EXPECT_EQ(listed(sut, 10'300)[0].robot, 1U);
  EXPECT_EQ(listed(sut, 10'300)[0].age_ms, 10'300U);
}

}  // namespace
}  // namespace swarm::launcher
