// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/launcher_beat.hpp"

#include <algorithm>
#include <cstddef>
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
  apart.push_back(1000);
  set_silent(beat, ids(apart));
  EXPECT_FALSE(beat.lists_all);
  EXPECT_EQ(beat.silent().size(), LauncherBeat::kMaxRanges);
}

TEST(LauncherBeat, IsDecodedAsItWasEncoded) {
  LauncherBeat beat{.run = 0x0123'4567'89AB'CDEF, .sequence = 42};
  set_silent(beat, ids({3, 4, 4'000'000'000}));
  beat.lists_all = false;
  std::vector<std::byte> bytes;
  encode(beat, bytes);

  const auto decoded = decode_beat(bytes);

  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->run, beat.run);
  EXPECT_EQ(decoded->sequence, 42U);
  EXPECT_FALSE(decoded->lists_all);
  EXPECT_TRUE(std::ranges::equal(decoded->silent(), beat.silent()));
}

TEST(LauncherBeat, IsNotDecodedFromOtherBytes) {
  LauncherBeat beat;
  set_silent(beat, ids({3}));
  std::vector<std::byte> bytes;
  encode(beat, bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    if (size == 20) continue;  // a beat without ranges
    EXPECT_FALSE(decode_beat(std::span(bytes).first(size))) << size;
  }
  bytes[16] = std::byte{2};
  EXPECT_FALSE(decode_beat(bytes)) << "neither all nor not all";
  EXPECT_FALSE(decode_beat(std::vector<std::byte>(20 + 8 * 101))) << "too many ranges";
  EXPECT_TRUE(decode_beat(std::vector<std::byte>(20 + 8 * 100)));
}

}  // namespace
}  // namespace swarm::link
