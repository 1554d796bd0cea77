// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/simulated_network.hpp"

#include <algorithm>
#include <iterator>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
using Received = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // (sender, number)

constexpr SteadyTime kBegin{std::chrono::seconds(1)};
constexpr Duration kPeriod = milliseconds(100);
const Box kBounds{{0, 0}, {50, 30}};
constexpr double kLargest_m = 6.0;

agent::NeighbourReport state(std::uint32_t robot, std::uint32_t number, const Vec2& at_m) {
  return {.robot = RobotId(robot),
          .sequence = number,
          .as_of = kBegin + number * kPeriod,
          .position_m = at_m};
}

// States of robots at random positions, some outside of the bounds, sent at one moment.
std::vector<agent::NeighbourReport> random_states(std::uint32_t robots, std::uint32_t number,
                                                  Rng& rng) {
  std::vector<agent::NeighbourReport> sent;
  for (std::uint32_t i = 0; i < robots; ++i) {
    sent.push_back(state(i, number, {uniform(rng, -15, 65), uniform(rng, -15, 45)}));
  }
  return sent;
}

Received received(const SimulatedNetwork& network, RobotId receiver, const Vec2& at_m,
                  double radius_m, SteadyTime from, SteadyTime until) {
  Received all;
  network.receive(receiver, at_m, radius_m, from, until, [&](const auto& report) {
    all.emplace_back(report.robot.value(), report.sequence);
  });
  std::sort(all.begin(), all.end());
  return all;
}

TEST(SimulatedNetwork, BringsEveryStateWithinTheRadiusAndNoOther) {
  Rng rng(1);
  SimulatedNetwork network(kBounds, kLargest_m, {}, 1, kBegin);
  const auto sent = random_states(400, 3, rng);
  network.post(kBegin + 3 * kPeriod, sent);
  int crossed_the_bounds = 0;
  for (int i = 0; i < 300; ++i) {
    const RobotId receiver(static_cast<std::uint32_t>(rng() % 400));
    const Vec2 at_m(uniform(rng, -15, 65), uniform(rng, -15, 45));
    const double radius_m = uniform(rng, 0.5, kLargest_m);  // a robot may have a smaller one
    Received expected;
    for (const agent::NeighbourReport& state : sent) {
      if (state.robot == receiver) continue;
      if ((state.position_m - at_m).norm() > radius_m) continue;
      expected.emplace_back(state.robot.value(), 3);
      crossed_the_bounds += kBounds.contains(at_m) != kBounds.contains(state.position_m) ? 1 : 0;
    }

    EXPECT_EQ(
        received(network, receiver, at_m, radius_m, kBegin + 3 * kPeriod, kBegin + 4 * kPeriod),
        expected);
  }
  EXPECT_GT(crossed_the_bounds, 20);
}

TEST(SimulatedNetwork, CountsTheRadiusItself) {
  SimulatedNetwork network(kBounds, 4.0, {}, 1, kBegin);
  const std::vector<agent::NeighbourReport> sent{state(1, 0, {14, 10}), state(2, 0, {10, 14.001})};
  network.post(kBegin, sent);

  EXPECT_EQ(received(network, RobotId(0), {10, 10}, 4.0, kBegin, kBegin + kPeriod),
            (Received{{1, 0}}));
}

TEST(SimulatedNetwork, IntervalsIncludeTheirBeginAndNotTheirEnd) {
  SimulatedNetwork network(kBounds, 4.0, {}, 1, kBegin);
  const std::vector<agent::NeighbourReport> sent{state(1, 0, {10, 10})};
  network.post(kBegin, sent);
  const Vec2 at_m(11, 10);

  EXPECT_TRUE(received(network, RobotId(0), at_m, 4.0, kBegin - kPeriod, kBegin).empty());
  EXPECT_EQ(received(network, RobotId(0), at_m, 4.0, kBegin, kBegin + kPeriod).size(), 1U);
  EXPECT_TRUE(
      received(network, RobotId(0), at_m, 4.0, kBegin + Duration(1), kBegin + kPeriod).empty());
}

// Loss, delay and jitter at once.
constexpr LinkFaults kBad{.loss = 0.3, .delay = milliseconds(150), .jitter = milliseconds(120)};

TEST(SimulatedNetwork, DoesNotDependOnHowTimeIsDividedIntoIntervals) {
  Rng rng(2);
  SimulatedNetwork network(kBounds, kLargest_m, kBad, 5, kBegin);
  for (std::uint32_t k = 0; k < 20; ++k) {
    network.post(kBegin + k * kPeriod, random_states(100, k, rng));
  }
  const SteadyTime end = kBegin + milliseconds(4000);
  std::size_t total = 0;
  for (std::uint32_t r = 0; r < 30; ++r) {
    const Vec2 at_m(uniform(rng, 0, 50), uniform(rng, 0, 30));
    const Received at_once = received(network, RobotId(r), at_m, kLargest_m, kBegin, end);
    Received in_parts;
    for (SteadyTime from = kBegin; from < end;) {
      const SteadyTime until =
          std::min(end, from + milliseconds(1 + static_cast<int>(rng() % 300)));
      const Received part = received(network, RobotId(r), at_m, kLargest_m, from, until);
      in_parts.insert(in_parts.end(), part.begin(), part.end());
      from = until;
    }
    std::sort(in_parts.begin(), in_parts.end());
    EXPECT_EQ(in_parts, at_once) << "nothing is lost between intervals or comes twice";
    total += at_once.size();
  }
  EXPECT_GT(total, 300U);
}

TEST(SimulatedNetwork, ForgetsOnlyWhatIsDueBefore) {
  Rng rng(3);
  SimulatedNetwork all(kBounds, kLargest_m, kBad, 5, kBegin);
  SimulatedNetwork forgetful(kBounds, kLargest_m, kBad, 5, kBegin);
  std::size_t total = 0;
  for (std::uint32_t k = 0; k < 40; ++k) {
    const auto sent = random_states(60, k, rng);
    const SteadyTime now = kBegin + k * kPeriod;
    all.post(now, sent);
    forgetful.post(now, sent);
    forgetful.forget(now);
    for (std::uint32_t r = 0; r < 10; ++r) {
      const Vec2 at_m(5.0 * r, 3.0 * r);
      const Received expected = received(all, RobotId(r), at_m, kLargest_m, now, now + kPeriod);
      EXPECT_EQ(received(forgetful, RobotId(r), at_m, kLargest_m, now, now + kPeriod), expected);
      total += expected.size();
    }
  }
  EXPECT_GT(total, 100U);
}

TEST(SimulatedNetwork, DecidesTheFateOfAMessageForEachReceiverAndSeed) {
  // 500 messages that reach both of two receivers, of which a half is lost.
  const LinkFaults faults{.loss = 0.5};
  const auto arrived = [&](std::uint64_t seed, std::uint32_t receiver) {
    SimulatedNetwork network(kBounds, kLargest_m, faults, seed, kBegin);
    for (std::uint32_t k = 0; k < 500; ++k) {
      const std::vector<agent::NeighbourReport> sent{state(9, k, {0, 0})};
      network.post(kBegin + k * kPeriod, sent);
    }
    return received(network, RobotId(receiver), {0, 1}, kLargest_m, kBegin, kBegin + 500 * kPeriod);
  };
  EXPECT_EQ(arrived(1, 0), arrived(1, 0));
  EXPECT_NE(arrived(1, 0), arrived(1, 1));
  EXPECT_NE(arrived(1, 0), arrived(2, 0));
  // Independent of each other: a quarter reaches both. Five standard deviations of a binomial.
  Received both;
  const Received one = arrived(1, 0);
  const Received other = arrived(1, 1);
  std::set_intersection(one.begin(), one.end(), other.begin(), other.end(),
                        std::back_inserter(both));
  EXPECT_NEAR(static_cast<double>(both.size()), 125.0, 5.0 * 9.7);
}

TEST(SimulatedNetwork, MayBeReadByThreadsAtATime) {
  Rng rng(4);
  SimulatedNetwork network(kBounds, kLargest_m, kBad, 5, kBegin);
  for (std::uint32_t k = 0; k < 10; ++k) {
    network.post(kBegin + k * kPeriod, random_states(100, k, rng));
  }
  const auto all_received = [&] {
    std::vector<Received> all;
    for (std::uint32_t r = 0; r < 50; ++r) {
      all.push_back(received(network, RobotId(r), {1.0 * r, 0.6 * r}, kLargest_m, kBegin,
                             kBegin + 30 * kPeriod));
    }
    return all;
  };
  const std::vector<Received> alone = all_received();
  std::vector<std::vector<Received>> by_thread(3);
  std::vector<std::thread> threads;
  for (auto& of_one : by_thread) threads.emplace_back([&] { of_one = all_received(); });
  for (std::thread& thread : threads) thread.join();

  for (const auto& of_one : by_thread) EXPECT_EQ(of_one, alone);
}

}  // namespace
}  // namespace swarm::launcher
