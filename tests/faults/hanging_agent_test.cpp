// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Agent processes that run and do nothing: from their start, or from some moment in flight.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/faults/edited_mission.hpp"

namespace swarm::test {
namespace {

TEST(HangingAgent, IsNamedKilledAndRestarted) {
  const EditedMission mission("  respawn_agent_max: 1\n");
  FlownRun run({}, mission.file());
  ASSERT_TRUE(run.mission_started());
  const pid_t hanging = run.agents().at(4);

  ::kill(hanging, SIGSTOP);

  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "agent-silent"); }));
  EXPECT_NE(read_text(run.dir() / "events.jsonl").find("agent process 5 (robots 4 to 4)"),
            std::string::npos);
  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "respawn"); }));
  run.launcher().wait();
  EXPECT_TRUE(has_event(run.dir(), "silent-killed"));
  EXPECT_EQ(run.summary()["lost"], nlohmann::json::array());
  EXPECT_EQ(run.summary()["arrived"], 12);
}

// A program that hangs before it has joined the bus.
TEST(HangingAgent, IsAbsentIfItHangsWhileItStarts) {
  const TemporaryFolder folder;
  const auto program = folder.path() / "agent";
  std::ofstream(program) << "#!/bin/sh\ncase \"$*\" in *'--ids 4 '*) exec sleep 600 ;; esac\nexec "
                         << SWARM_BIN_DIR << "/robot_agent \"$@\"\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const EditedMission mission("  quorum_share: 0.9\n  quorum_timeout_s: 20\n");
  FlownRun run({"--agent-program", program.string()}, mission.file());

  run.launcher().wait();

  EXPECT_TRUE(has_event(run.dir(), "quorum"));
  EXPECT_NE(run.summary()["outcome"], "time_limit");
  EXPECT_EQ(run.summary()["arrived"], 11);
  EXPECT_EQ(run.summary()["lost"], nlohmann::json({4}));
}

}  // namespace
}  // namespace swarm::test
