// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The counts against sets of numbers; tests/unit/experiments/soak has the single cases.
#include "swarm_link/stream_meter.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

constexpr UtcTime kNow{std::chrono::seconds(1'700'000'000)};
constexpr auto kLast = std::numeric_limits<std::uint32_t>::max();

void receive(StreamMeter& meter, std::uint32_t robot, std::uint32_t number) {
  meter.receive({.robot_id = robot,
                 .sequence_number = number,
                 .stamp_utc_ns = kNow.time_since_epoch().count()},
                kNow);
}

/// What arrives of numbers from `first` on: some are lost, some come twice, and all come up to 30
/// places late.
std::vector<std::uint32_t> arrivals(Rng& rng, std::uint32_t first, std::uint32_t count) {
  std::vector<std::pair<double, std::uint32_t>> due;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (uniform01(rng) < 0.2) continue;
    const int copies = uniform01(rng) < 0.1 ? 2 : 1;
    for (int copy = 0; copy < copies; ++copy) {
      due.emplace_back(i + uniform(rng, 0.0, 30.0), first + i);
    }
  }
  std::sort(due.begin(), due.end());
  std::vector<std::uint32_t> numbers;
  for (const auto& [time, number] : due) numbers.push_back(number);
  return numbers;
}

TEST(StreamMeter, CountsAsSetsOfNumbersDo) {
  Rng rng(21);
  for (int round = 0; round < 200; ++round) {
    constexpr std::uint32_t kRobots = 3;
    StreamMeter meter(kRobots);
    std::uint64_t received = 0, lost = 0, duplicates = 0, reordered = 0;
    for (std::uint32_t robot = 0; robot < kRobots; ++robot) {
      // Also up to the last number that 32 bits hold.
      const std::uint32_t first =
          round % 2 == 0 ? 1 + static_cast<std::uint32_t>(rng() % 50) : kLast - 299;
      const auto numbers = arrivals(rng, first, 300);
      std::set<std::uint32_t> seen;
      for (const std::uint32_t number : numbers) {
        reordered += !seen.empty() && number < *seen.rbegin() && !seen.contains(number) ? 1 : 0;
        duplicates += seen.insert(number).second ? 0 : 1;
        receive(meter, robot, number);
      }
      received += seen.size();
      for (std::uint32_t n = numbers.front(); n < *seen.rbegin(); ++n) {
        lost += seen.contains(n) ? 0 : 1;  // counting begins with the first that arrives
      }
    }

    EXPECT_EQ(meter.counts().received, received);
    EXPECT_EQ(meter.counts().lost, lost);
    EXPECT_EQ(meter.counts().duplicates, duplicates);
    EXPECT_EQ(meter.counts().reordered, reordered);
    EXPECT_EQ(meter.latency().count(), received) << "duplicates have no latency";
  }
}

TEST(StreamMeter, DoesNotTakeAnEarlierFirstStateForALostOneOfAnother) {
  StreamMeter meter(2);
  receive(meter, 0, 1);
  receive(meter, 0, 3);  // 2 is lost
  receive(meter, 1, 8);
  receive(meter, 1, 7);  // sent before the first one that arrived

  EXPECT_EQ(meter.counts().lost, 1U);
  EXPECT_EQ(meter.counts().reordered, 1U);
}

TEST(StreamMeter, TakesANumber64OrMoreBelowTheHighestForARestart) {
  for (const std::uint32_t back : {63U, 64U, 65U}) {
    StreamMeter meter(1);
    receive(meter, 0, 100);
    receive(meter, 0, 100 - back);
    receive(meter, 0, 100 - back + 1);

    EXPECT_EQ(meter.counts().received, 3U) << back;
    EXPECT_EQ(meter.counts().duplicates, 0U) << back;
    EXPECT_EQ(meter.counts().reordered, back < 64 ? 2U : 0U) << back;
  }
}

TEST(StreamMeter, GoesOnWhereTheNumbersWrapAround) {
  StreamMeter meter(1);
  for (const std::uint32_t number : {kLast - 1, kLast, 0U, 1U, 2U}) receive(meter, 0, number);
  EXPECT_EQ(meter.counts().received, 5U);
  EXPECT_EQ(meter.counts().lost, 0U);
}

TEST(StreamMeter, CountsAStampOfTheFutureAsNoLatency) {
  StreamMeter meter(1);
  meter.receive({.sequence_number = 1, .stamp_utc_ns = kNow.time_since_epoch().count() + 5'000'000},
                kNow);
  EXPECT_EQ(meter.latency().count(), 1U);
  EXPECT_EQ(meter.latency().max_us(), 0);
  EXPECT_EQ(meter.worst().latency_us, 0);
}

}  // namespace
}  // namespace swarm::link
