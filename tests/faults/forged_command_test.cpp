// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A stranger sends a command or a scene that is newer than the launcher's.
#include <cstdint>
#include <string>

#include "swarm_link/topics.hpp"
#include "tests/system/hostile/intruder.hpp"

namespace swarm::test {
namespace {

constexpr std::int64_t kAhead_ns = 9'000'000'000;  // robots accept ids up to 10 s ahead

/// Published once to all robots and the planner; then the launcher must log an event.
template <class M>
void forge(const FlownRun& run, const link::Topic<M>& topic, const M& message,
           const std::string& event) {
  const auto participant = intrude(run);
  ASSERT_TRUE(participant) << participant.error().message;
  const auto writer = (*participant)->make_writer(topic).value();
  ASSERT_TRUE(eventually([&] { return writer->matched() >= 13; }));
  writer->write(message);
  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), event); })) << event;
}

// The launcher's commands of the next nine seconds would be out of date to robots that follow it.
TEST(ForgedCommand, PauseIsOverruledAndTheUsersCommandsAreObeyed) {
  FlownRun run({"--channel", "topics"});
  ASSERT_TRUE(run.mission_started()) << run.outcome();

  const std::int64_t now = utc_ns();
  forge(run, link::command_topic(),
        link::CommandMessage{.kind = CommandKind::kPause,
                             .command_id = static_cast<std::uint64_t>(now + kAhead_ns),
                             .stamp_utc_ns = now},
        "command-foreign");
  for (const std::string command : {"pause", "resume"}) {
    Program program("swarm_launcher", {"command", run.dir().string(), command});
    EXPECT_EQ(program.wait(), 0) << program.err();
    EXPECT_NE(program.out().find("12 robots confirmed"), std::string::npos) << program.out();
  }

  expect_all_arrive(run);
}

// It would let the robots fly through the obstacles of the mission. The verdict is not "ok", as
// what some robots flew by for a second is not in the run directory.
TEST(ForgedCommand, SceneWithoutObstaclesIsOverruledAndReported) {
  FlownRun run({"--channel", "topics"});
  ASSERT_TRUE(run.mission_started()) << run.outcome();

  forge(run, link::scene_topic(),
        link::SceneMessage{.version = static_cast<std::uint64_t>(utc_ns() + kAhead_ns),
                           .next_id = 2,
                           .removed = {0, 1}},
        "scene-foreign");

  EXPECT_EQ(run.launcher().wait(), 1) << run.outcome();
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
  EXPECT_EQ(summary["reasons"].dump(),
            R"(["missing: 1 scene that robots took and scene.jsonl lacks"])");
}

}  // namespace
}  // namespace swarm::test
