// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/faulty_path.hpp"

#include <gtest/gtest.h>

namespace swarm::link {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr UtcTime kBegan{seconds(1000)};

struct Received final : DatagramSink {
  void datagram(std::span<std::byte> bytes, const sockaddr_in&) override {
    numbers.push_back(static_cast<int>(bytes[0]));
  }
  std::vector<int> numbers;
};

void receive(FaultyPath& path, int fd, int number, UtcTime at) {
  const std::byte byte{static_cast<unsigned char>(number)};
  path.receive(fd, {&byte, 1}, {}, at);
}

TEST(FaultyPath, KeepsWhatIsLateUntilItIsDue) {
  FaultyPath path({.faults = {.delay = milliseconds(150)}, .run_began = kBegan});
  Received received;
  receive(path, 3, 1, kBegan);
  receive(path, 3, 2, kBegan + milliseconds(20));

  path.hand_due(3, kBegan + milliseconds(149), received);
  EXPECT_TRUE(received.numbers.empty());
  path.hand_due(3, kBegan + milliseconds(150), received);
  EXPECT_EQ(received.numbers, std::vector({1}));
  path.hand_due(3, kBegan + milliseconds(500), received);
  EXPECT_EQ(received.numbers, std::vector({1, 2}));
}

TEST(FaultyPath, KeepsSocketsApart) {
  FaultyPath path({.faults = {.delay = milliseconds(10)}, .run_began = kBegan});
  Received received;
  receive(path, 3, 1, kBegan);
  receive(path, 4, 2, kBegan);
  receive(path, 3, 3, kBegan);

  path.hand_due(4, kBegan + seconds(1), received);
  EXPECT_EQ(received.numbers, std::vector({2}));
  path.hand_due(3, kBegan + seconds(1), received);
  EXPECT_EQ(received.numbers, std::vector({2, 1, 3}));
}

TEST(FaultyPath, ForgetsWhatIsForAClosedSocket) {
  FaultyPath path({.faults = {.delay = milliseconds(10)}, .run_began = kBegan});
  Received received;
  receive(path, 3, 1, kBegan);

  path.hand_due(4, kBegan + seconds(6), received);
  path.hand_due(3, kBegan + seconds(6), received);
  EXPECT_TRUE(received.numbers.empty());
}

TEST(FaultyPath, IsBadOnlyWhenItIsToBe) {
  FaultyPath path(
      {.faults = {.loss = 1.0, .from = seconds(10), .until = seconds(20)}, .run_began = kBegan});
  Received received;
  receive(path, 3, 1, kBegan + milliseconds(9'999));
  receive(path, 3, 2, kBegan + seconds(10));
  receive(path, 3, 3, kBegan + seconds(20));

  path.hand_due(3, kBegan + seconds(20), received);
  EXPECT_EQ(received.numbers, std::vector({1, 3}));
}

TEST(FaultyPath, DoesTheSameForTheSameSeed) {
  const auto survivors = [](std::uint64_t seed) {
    FaultyPath path(
        {.faults = {.loss = 0.5, .jitter = milliseconds(50)}, .seed = seed, .run_began = kBegan});
    Received received;
    for (int i = 0; i < 100; ++i) receive(path, 3, i, kBegan);
    path.hand_due(3, kBegan + seconds(1), received);
    return received.numbers;
  };

  EXPECT_EQ(survivors(7), survivors(7));
  EXPECT_NE(survivors(7), survivors(8));
  EXPECT_NEAR(static_cast<double>(survivors(7).size()), 50.0, 20.0);
}

}  // namespace
}  // namespace swarm::link
