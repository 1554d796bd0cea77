// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/base/lanes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace swarm {
namespace {

// The mask that has those lanes set whose bits are.
Int4 mask_of(std::uint32_t bits) {
  Int4 mask{};
  for (std::uint32_t lane = 0; lane < kLanes; ++lane)
    mask[lane] = (bits >> lane & 1U) != 0 ? -1 : 0;
  return mask;
}

TEST(Lanes, BitsAreThoseOfTheMask) {
  for (std::uint32_t bits = 0; bits < 16; ++bits) EXPECT_EQ(bits_of(mask_of(bits)), bits);
}

TEST(Lanes, WriteSetAppendsTheNumbersOfSetBitsInOrder) {
  for (std::uint32_t bits = 0; bits < 16; ++bits) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      if ((bits >> lane & 1U) != 0) expected.push_back(100 + lane);
    }
    std::array<std::uint32_t, kLanes> written{};

    std::uint32_t* const end = write_set(bits, 100, written.data());

    EXPECT_EQ(std::vector<std::uint32_t>(written.data(), end), expected);
  }
}

TEST(Lanes, SmallerAndLargerNumbersAreTakenLaneByLane) {
  const std::array<float, 5> numbers{0, 4, 3, 2, 1};  // read from an address that is not aligned
  const Float4 least = min(load(&numbers[1]), all(2.5F));
  const Float4 most = max(load(&numbers[1]), all(2.5F));
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    EXPECT_EQ(least[lane], std::min(numbers[1 + lane], 2.5F));
    EXPECT_EQ(most[lane], std::max(numbers[1 + lane], 2.5F));
  }
}

}  // namespace
}  // namespace swarm
