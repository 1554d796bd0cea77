// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/silence_watch.hpp"

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Change = SilenceWatch::Change;

SteadyTime at_s(double s) { return SteadyTime(from_seconds(s)); }

TEST(SilenceLimits, HoldForTheUsualRatesAndGrowWithSlowOnes) {
  EXPECT_EQ(SilenceLimits::of(1.0).reported, seconds(3));
  EXPECT_EQ(SilenceLimits::of(1.0).ended, seconds(10));
  EXPECT_EQ(SilenceLimits::of(5.0).reported, seconds(3));
  EXPECT_EQ(SilenceLimits::of(0.1).reported, seconds(30));
  EXPECT_EQ(SilenceLimits::of(0.1).ended, seconds(100));
}

TEST(SilenceWatch, ReportsEachSilenceAndEachReturnOnce) {
  SilenceWatch sut;
  const SilenceLimits limits;
  sut.on_start(at_s(0));
  sut.on_received();
  EXPECT_EQ(sut.step(at_s(1), limits), Change::kNone);
  EXPECT_EQ(sut.step(at_s(4), limits), Change::kNone) << "exactly at the limit";
  EXPECT_EQ(sut.step(at_s(4.01), limits), Change::kSilent);
  EXPECT_EQ(sut.step(at_s(9), limits), Change::kNone);
  EXPECT_TRUE(sut.is_silent());
  sut.on_received();
  EXPECT_EQ(sut.step(at_s(10), limits), Change::kBack);
  EXPECT_FALSE(sut.is_silent());
}

TEST(SilenceWatch, IsOverdueAfterTheSecondLimit) {
  SilenceWatch sut;
  const SilenceLimits limits;
  sut.on_start(at_s(0));
  sut.on_received();
  sut.step(at_s(1), limits);
  EXPECT_FALSE(sut.is_overdue(at_s(11), limits));
  EXPECT_TRUE(sut.is_overdue(at_s(11.01), limits));
  sut.restart(at_s(11.01));
  EXPECT_FALSE(sut.is_overdue(at_s(21), limits)) << "the receiver itself was suspended";
}

TEST(SilenceWatch, OnlyCountsTheTimeOfOneThatIsStartingApart) {
  SilenceWatch sut;
  const SilenceLimits limits;
  sut.on_start(at_s(0));
  EXPECT_EQ(sut.step(at_s(100), limits), Change::kNone);
  EXPECT_FALSE(sut.is_overdue(at_s(100), limits));
  EXPECT_EQ(sut.unreceived_for(at_s(100)), seconds(100));

  sut.on_received();
  sut.step(at_s(100), limits);
  EXPECT_EQ(sut.unreceived_for(at_s(200)), Duration::zero());
  sut.on_start(at_s(200));
  EXPECT_EQ(sut.unreceived_for(at_s(201)), seconds(1)) << "the process that was restarted";
}

}  // namespace
}  // namespace swarm::launcher
