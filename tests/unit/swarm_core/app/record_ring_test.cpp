// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/record_ring.hpp"

#include <deque>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"
#include "tests/unit/swarm_core/files/fake_disk.hpp"

namespace swarm::shell {
namespace {

using files::bytes_of;

std::string take(RecordRing& ring, std::size_t most_bytes, std::uint64_t& records) {
  std::vector<unsigned char> bytes;
  const RecordRing::Taken taken = ring.copy(bytes, most_bytes);
  ring.pop(taken);
  records = taken.records;
  return {bytes.begin(), bytes.end()};
}

TEST(RecordRing, HandsOutBlocksInTheirOrder) {
  RecordRing sut(256);
  EXPECT_TRUE(sut.is_empty());
  EXPECT_TRUE(sut.push(bytes_of("one"), 1));
  EXPECT_TRUE(sut.push(bytes_of(""), 2));
  EXPECT_TRUE(sut.push(bytes_of("three"), 3));
  EXPECT_EQ(sut.waiting(), 6U);
  std::uint64_t records = 0;
  EXPECT_EQ(take(sut, 256, records), "onethree");
  EXPECT_EQ(records, 6U);
  EXPECT_TRUE(sut.is_empty());
}

TEST(RecordRing, HandsOutAtLeastOneBlockHoweverLong) {
  RecordRing sut(256);
  EXPECT_TRUE(sut.push(bytes_of("0123456789"), 1));
  EXPECT_TRUE(sut.push(bytes_of("abc"), 1));
  std::uint64_t records = 0;
  EXPECT_EQ(take(sut, 4, records), "0123456789");
  EXPECT_EQ(take(sut, 4, records), "abc");
}

TEST(RecordRing, RefusesWhatDoesNotFitAndTakesItLater) {
  RecordRing sut(64);
  EXPECT_FALSE(sut.push(bytes_of(std::string(57, 'x')), 1)) << "the block's length takes room, too";
  EXPECT_TRUE(sut.push(bytes_of(std::string(24, 'a')), 1));
  EXPECT_TRUE(sut.push(bytes_of(std::string(24, 'b')), 1));
  EXPECT_FALSE(sut.push(bytes_of("c"), 1));
  std::uint64_t records = 0;
  EXPECT_EQ(take(sut, 24, records), std::string(24, 'a'));
  EXPECT_TRUE(sut.push(bytes_of("c"), 1));
  EXPECT_EQ(take(sut, 64, records), std::string(24, 'b') + "c");
}

// Against a queue without limits, with blocks of all lengths.
TEST(RecordRing, HoldsWhatAQueueHolds) {
  Rng rng(5);
  RecordRing sut(512);
  std::deque<std::string> expected;
  std::uint64_t refused = 0;
  for (int step = 0; step < 20'000; ++step) {
    if (rng() % 2 == 0) {
      const std::string block(rng() % 200, static_cast<char>('a' + step % 26));
      if (sut.push(bytes_of(block), 1)) {
        expected.push_back(block);
      } else {
        ++refused;
      }
      continue;
    }
    std::uint64_t records = 0;
    const std::string got = take(sut, rng() % 300, records);
    std::string wanted;
    for (std::uint64_t i = 0; i < records; ++i) {
      ASSERT_FALSE(expected.empty());
      wanted += expected.front();
      expected.pop_front();
    }
    ASSERT_EQ(got, wanted) << step;
    ASSERT_EQ(sut.is_empty(), expected.empty());
  }
  EXPECT_GT(refused, 100U);
}

// An empty ring goes back to its begin, from wherever it is. While the disk then takes nothing,
// what the consumer copies stays in the ring; all room but that of the blocks must be there.
TEST(RecordRing, HasAllItsRoomAfterItWentBackToItsBegin) {
  constexpr std::size_t kCapacity = 1U << 16U;
  constexpr std::size_t kBlock = 56, kWithFront = kBlock + 8;
  const std::string text(kBlock, 'x');
  const auto block = bytes_of(text);
  for (std::size_t blocks_before = 1; blocks_before <= 1100; blocks_before += 7) {
    RecordRing sut(kCapacity);
    std::uint64_t records = 0;
    for (std::size_t i = 0; i < blocks_before; ++i) {
      ASSERT_TRUE(sut.push(block, 1));
      take(sut, kBlock, records);
    }
    ASSERT_TRUE(sut.push(block, 1));

    std::vector<unsigned char> not_written;
    sut.copy(not_written, kCapacity);

    std::size_t waiting = 1;
    while (sut.push(block, 1)) ++waiting;
    EXPECT_GE(waiting, kCapacity / kWithFront - 1) << blocks_before;
    EXPECT_EQ(sut.waiting(), waiting);
    EXPECT_TRUE(take(sut, kCapacity, records) == std::string(waiting * kBlock, 'x'));
  }
}

// The consumer is a thread that may not run for a while, for instance as the disk does not answer.
TEST(RecordRing, HasHalfOfItsRoomBeforeTheConsumerLooksAtIt) {
  constexpr std::size_t kCapacity = 1U << 13U;
  constexpr std::size_t kBlock = 56, kWithFront = kBlock + 8;
  const std::string text(kBlock, 'x');
  const auto block = bytes_of(text);
  for (std::size_t blocks_before = 0; blocks_before <= 140; ++blocks_before) {
    RecordRing sut(kCapacity);
    std::uint64_t records = 0;
    for (std::size_t i = 0; i < blocks_before; ++i) {
      ASSERT_TRUE(sut.push(block, 1));
      take(sut, kBlock, records);
    }

    std::size_t waiting = 0;
    while (sut.push(block, 1)) ++waiting;

    EXPECT_GE(waiting, kCapacity / 2 / kWithFront) << blocks_before;
    EXPECT_TRUE(take(sut, kCapacity, records) == std::string(waiting * kBlock, 'x'));
  }
}

TEST(RecordRing, PassesBytesBetweenTwoThreads) {
  RecordRing sut(1024);
  constexpr int kBlocks = 100'000;
  std::thread producer([&sut] {
    for (int i = 0; i < kBlocks;) {
      if (sut.push(bytes_of(std::to_string(i) + "\n"), 1)) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::string text;
  for (std::uint64_t total = 0; total < kBlocks;) {
    std::uint64_t records = 0;
    text += take(sut, 300, records);
    total += records;
    if (records == 0) std::this_thread::yield();
  }
  producer.join();
  std::string wanted;
  for (int i = 0; i < kBlocks; ++i) wanted += std::to_string(i) + "\n";
  EXPECT_TRUE(text == wanted);
}

}  // namespace
}  // namespace swarm::shell
