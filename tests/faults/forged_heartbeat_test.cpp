// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A stranger sends heartbeats as a planner that has started just now.
#include <chrono>
#include <thread>

#include "swarm_link/topics.hpp"
#include "tests/system/hostile/intruder.hpp"

namespace swarm::test {
namespace {

// Were the newest epoch to lead, the swarm would hold for good, without a plan of that epoch.
TEST(ForgedHeartbeat, OfALaterEpochDoesNotLockThePlannerOut) {
  FlownRun run({"--channel", "topics"});
  ASSERT_TRUE(run.mission_started()) << run.launcher().err();
  const auto participant = intrude(run);
  ASSERT_TRUE(participant) << participant.error().message;
  const auto beats = (*participant)->make_writer(link::heartbeat_topic()).value();
  ASSERT_TRUE(eventually([&] { return beats->matched() >= 12; }));

  const auto epoch = static_cast<std::uint64_t>(utc_ns());
  for (std::uint64_t i = 1; i <= 20; ++i) {
    beats->write({.phase = link::MissionPhase::kRunning,
                  .version = 1,
                  .epoch = epoch,
                  .sequence_number = i,
                  .stamp_utc_ns = utc_ns()});
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }

  EXPECT_EQ(run.launcher().wait(), 0) << run.launcher().err();
  EXPECT_EQ(run.summary()["arrived"], 12);
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

}  // namespace
}  // namespace swarm::test
