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

TEST(FaultyPath, DeliversSomeTwice) {
  FaultyPath path({.faults = {.delay = milliseconds(10), .duplicate = 1.0}, .run_began = kBegan});
  Received received;
  receive(path, 3, 1, kBegan);

  path.hand_due(3, kBegan + seconds(1), received);
  EXPECT_EQ(received.numbers, std::vector({1, 1}));
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

TEST(FaultyPath, DeliversInTheOrderOfDueTimesAndOfArrivalAmongEqualOnes) {
  FaultyPath path({.faults = {.delay = milliseconds(40)}, .run_began = kBegan});
  Received received;
  receive(path, 3, 1, kBegan + milliseconds(20));
  receive(path, 3, 2, kBegan);
  receive(path, 3, 3, kBegan + milliseconds(20));
  receive(path, 3, 4, kBegan + milliseconds(10));

  path.hand_due(3, kBegan + seconds(1), received);

  EXPECT_EQ(received.numbers, std::vector({2, 4, 1, 3}));
}

// The fates are those of fate(), by the count of what arrived while faults were in force.
TEST(FaultyPath, DrawsTheSameFatesWhateverCameBeforeTheFaults) {
  const LinkFaults faults{.loss = 0.4, .delay = milliseconds(5), .from = seconds(10)};
  for (const int before : {0, 1, 17}) {
    FaultyPath path({.faults = faults, .seed = 9, .run_began = kBegan});
    Received received;
    for (int i = 0; i < before; ++i) receive(path, 3, 255, kBegan);
    path.hand_due(3, kBegan + seconds(1), received);
    EXPECT_EQ(received.numbers, std::vector<int>(static_cast<std::size_t>(before), 255));
    received.numbers.clear();
    std::vector<int> expected;
    for (int i = 0; i < 60; ++i) {
      receive(path, 3, i, kBegan + seconds(10));
      if (fate(faults, 9, static_cast<std::uint64_t>(i))) expected.push_back(i);
    }

    path.hand_due(3, kBegan + seconds(20), received);

    EXPECT_EQ(received.numbers, expected);
  }
}

TEST(FaultyPath, LosesWhatDoesNotFitIntoItsQueue) {
  FaultyPath path({.faults = {.delay = seconds(1)}, .run_began = kBegan});
  for (int i = 0; i < 8192 + 100; ++i) receive(path, 3, i < 8192 ? 1 : 2, kBegan);
  Received received;

  path.hand_due(3, kBegan + seconds(2), received);

  EXPECT_EQ(received.numbers, std::vector<int>(8192, 1)) << "the first ones stay";
  receive(path, 3, 3, kBegan + seconds(2));
  received.numbers.clear();
  path.hand_due(3, kBegan + seconds(4), received);
  EXPECT_EQ(received.numbers, std::vector({3})) << "there is room again";
}

TEST(FaultyPath, KeepsTheSenderOfADatagram) {
  struct Sender final : DatagramSink {
    void datagram(std::span<std::byte>, const sockaddr_in& sender) override {
      port = sender.sin_port;
    }
    in_port_t port = 0;
  } sink;
  FaultyPath path({.faults = {.delay = milliseconds(1)}, .run_began = kBegan});
  path.receive(3, {}, {.sin_family = AF_INET, .sin_port = 4711, .sin_addr = {}, .sin_zero = {}},
               kBegan);

  path.hand_due(3, kBegan + seconds(1), sink);

  EXPECT_EQ(sink.port, 4711);
}

}  // namespace
}  // namespace swarm::link
