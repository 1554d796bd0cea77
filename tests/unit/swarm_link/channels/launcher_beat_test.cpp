// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/launcher_beat.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

std::vector<RobotId> ids(const std::vector<std::uint32_t>& numbers) {
  std::vector<RobotId> out;
  for (const std::uint32_t number : numbers) out.emplace_back(number);
  return out;
}

TEST(LauncherBeat, JoinsConsecutiveIdsToRanges) {
  LauncherBeat beat;
  set_silent(beat, ids({0, 1, 2, 7, 9, 10}));
  EXPECT_TRUE(std::ranges::equal(beat.silent(), std::vector<RobotRange>{{0, 3}, {7, 1}, {9, 2}}));
  EXPECT_TRUE(beat.lists_all);
  set_silent(beat, {});
  EXPECT_TRUE(beat.silent().empty());
}

TEST(LauncherBeat, StatesThatItHasNoRoomForAll) {
  LauncherBeat beat;
  std::vector<std::uint32_t> apart;
  for (std::uint32_t i = 0; i < LauncherBeat::kMaxRanges; ++i) apart.push_back(2 * i);
  set_silent(beat, ids(apart));
  EXPECT_TRUE(beat.lists_all);
  apart.push_back(5000);
  set_silent(beat, ids(apart));
  EXPECT_FALSE(beat.lists_all);
  EXPECT_EQ(beat.silent().size(), LauncherBeat::kMaxRanges);
}

TEST(LauncherBeat, HasTheFirstLateRobotsThatItHasRoomFor) {
  LauncherBeat beat;
  set_late(beat, std::vector<LateRobot>(LauncherBeat::kMaxLate + 1, LateRobot{.robot = 7}));
  EXPECT_EQ(beat.late().size(), LauncherBeat::kMaxLate);
  EXPECT_FALSE(beat.lists_all_late);
  set_late(beat, std::vector<LateRobot>{{.robot = 1}, {.robot = 2}});
  ASSERT_EQ(beat.late().size(), 2U);
  EXPECT_TRUE(beat.lists_all_late);
  EXPECT_EQ(beat.late()[0].robot, 1U);
}

TEST(LauncherBeat, IsDecodedAsItWasEncoded) {
  LauncherBeat beat{.run = 0x0123'4567'89AB'CDEF, .sequence = 42, .sent_ns = -7};
  set_silent(beat, ids({3, 4, 4'000'000'000}));
  set_late(beat, std::vector<LateRobot>{{.robot = 5, .age_ms = 1300, .x_m = -1.5, .y_m = 1e6},
                                        {.robot = 9, .age_ms = 2900, .x_m = 0.0, .y_m = 2.0}});
  beat.lists_all = false;
  std::vector<std::byte> bytes;
  encode(beat, bytes);

  LauncherBeat decoded{.ranges = 3, .late_robots = 5};  // of an earlier one

  ASSERT_TRUE(decode(bytes, decoded));
  EXPECT_EQ(decoded.run, beat.run);
  EXPECT_EQ(decoded.sequence, 42U);
  EXPECT_EQ(decoded.sent_ns, -7);
  EXPECT_TRUE(decoded.lists_all_late);
  EXPECT_FALSE(decoded.lists_all);
  EXPECT_TRUE(std::ranges::equal(decoded.silent(), beat.silent()));
  EXPECT_TRUE(std::ranges::equal(decoded.late(), beat.late()));
}

bool is_beat(std::span<const std::byte> bytes) {
  LauncherBeat beat{.run = 9};
  const bool is = decode(bytes, beat);
  EXPECT_TRUE(is || beat.run == 9) << "unchanged";
  return is;
}

TEST(LauncherBeat, IsNotDecodedFromOtherBytes) {
  constexpr std::size_t kFixed = 32, kRange = 8, kLate = 24;
  LauncherBeat beat;
  set_silent(beat, ids({3}));
  set_late(beat, std::vector<LateRobot>(2));
  std::vector<std::byte> bytes;
  encode(beat, bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    if (size == kFixed + kRange || size == kFixed + kRange + kLate) continue;  // less late robots
    EXPECT_FALSE(is_beat(std::span(bytes).first(size))) << size;
  }
  bytes[24] = std::byte{4};
  EXPECT_FALSE(is_beat(bytes)) << "an unknown flag";

  const auto beat_of = [](std::size_t ranges, std::size_t late) {
    std::vector<std::byte> made(kFixed + kRange * ranges + kLate * late);
    made[28] = static_cast<std::byte>(ranges & 0xFFU);
    made[29] = static_cast<std::byte>(ranges >> 8U);
    return is_beat(made);
  };
  EXPECT_TRUE(beat_of(LauncherBeat::kMaxRanges, LauncherBeat::kMaxLate));
  EXPECT_FALSE(beat_of(LauncherBeat::kMaxRanges + 1, 0));
  EXPECT_FALSE(beat_of(0, LauncherBeat::kMaxLate + 1));
}

}  // namespace
}  // namespace swarm::link
