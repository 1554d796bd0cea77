// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/event_throttle.hpp"

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr SteadyTime kBegin{seconds(1000)};

TEST(EventThrottle, AdmitsWhatAHealthyProcessReports) {
  EventThrottle sut;
  for (int i = 0; i < 5000; ++i) {
    ASSERT_TRUE(sut.admit(7, kBegin + milliseconds(200) * i)) << i;
  }
  EXPECT_FALSE(sut.report(kBegin + seconds(10'000)));
}

TEST(EventThrottle, LogsABurstAndThenTheRateOfAFlood) {
  EventThrottle sut;
  int admitted = 0;
  for (int i = 0; i < 20'000; ++i) {  // 20 000 events in 4 s
    admitted += sut.admit(7, kBegin + from_seconds(4.0 * i / 20'000)) ? 1 : 0;
  }
  EXPECT_GE(admitted, static_cast<int>(EventThrottle::kBurst));
  EXPECT_LE(admitted, static_cast<int>(EventThrottle::kBurst + 4 * EventThrottle::kPerSecond) + 1);
}

TEST(EventThrottle, AFloodOfOneSenderDoesNotSilenceAnother) {
  EventThrottle sut;
  for (int i = 0; i < 10'000; ++i) sut.admit(7, kBegin);
  EXPECT_FALSE(sut.admit(7, kBegin));
  EXPECT_TRUE(sut.admit(8, kBegin));
}

TEST(EventThrottle, ReportsWhatItDroppedOnceInTenSeconds) {
  EventThrottle sut;
  const auto flood = [&](SteadyTime at) {
    for (int i = 0; i < 300; ++i) sut.admit(7, at);
  };
  flood(kBegin);
  EXPECT_EQ(sut.report(kBegin), "100 events of 1 sender were not logged: more than 5 a second");
  flood(kBegin + seconds(1));
  EXPECT_FALSE(sut.report(kBegin + seconds(9)));
  EXPECT_EQ(sut.report(kBegin + seconds(10)),
            "295 events of 1 sender were not logged: more than 5 a second");
  EXPECT_FALSE(sut.report(kBegin + seconds(30))) << "nothing was dropped since";
}

TEST(EventThrottle, SendersWithoutNumberShareOneBucket) {
  EventThrottle sut;
  const auto known = static_cast<std::uint64_t>(EventThrottle::kMostSenders);
  for (std::uint64_t sender = 0; sender < known; ++sender) sut.admit(sender, kBegin);
  std::uint64_t admitted = 0;
  for (std::uint64_t sender = known; sender < 3 * known; ++sender) {
    admitted += sut.admit(sender, kBegin) ? 1U : 0U;
  }
  EXPECT_EQ(admitted, static_cast<std::uint64_t>(EventThrottle::kBurst));
  EXPECT_TRUE(sut.admit(3, kBegin)) << "those that were known keep their own";
}

}  // namespace
}  // namespace swarm::launcher
