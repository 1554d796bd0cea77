// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A stranger sends heartbeats as another planner.
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

#include "swarm_link/topics.hpp"
#include "tests/system/hostile/intruder.hpp"

namespace swarm::test {
namespace {

/// Twenty heartbeats of a planner that began `after_s` seconds after now, within two seconds.
void forge(const FlownRun& run, std::int64_t after_s) {
  const auto participant = intrude(run);
  ASSERT_TRUE(participant) << participant.error().message;
  const auto beats = (*participant)->make_writer(link::heartbeat_topic()).value();
  ASSERT_TRUE(eventually([&] { return beats->matched() >= 12; }));
  const auto epoch = static_cast<std::uint64_t>(utc_ns() + after_s * 1'000'000'000);
  for (std::uint64_t i = 1; i <= 20; ++i) {
    beats->write({.phase = link::MissionPhase::kRunning,
                  .version = 1,
                  .epoch = epoch,
                  .sequence_number = i,
                  .stamp_utc_ns = utc_ns()});
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

// Were the newest epoch to lead, the swarm would hold for good, without a plan of that epoch.
TEST(ForgedHeartbeat, OfALaterEpochDoesNotLockThePlannerOut) {
  FlownRun run({"--channel", "topics"});
  ASSERT_TRUE(run.mission_started()) << run.outcome();

  forge(run, 0);

  expect_all_arrive(run);
}

// Of two planners the one that began first leads, so the run's own one stands down; it leads again
// when the other falls silent.
TEST(ForgedHeartbeat, OfAnEarlierEpochIsOutlived) {
  FlownRun run({"--channel", "topics"});
  ASSERT_TRUE(run.mission_started()) << run.outcome();

  forge(run, -3600);

  expect_all_arrive(run);
  EXPECT_TRUE(has_event(run.dir(), "planner-standby"));
  EXPECT_TRUE(has_event(run.dir(), "planner-takeover"));
}

}  // namespace
}  // namespace swarm::test
