// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Ending a run: Ctrl-C at any moment, and the emergency stop.
#include <chrono>
#include <csignal>
#include <thread>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

void expect_all_gone_and_summarised(FlownRun& run, const std::vector<Child>& children) {
  EXPECT_EQ(run.launcher().wait(), 1) << run.outcome();
  for (const Child& child : children) {
    EXPECT_NE(::kill(child.pid, 0), 0) << child.program << " " << child.pid;
  }
  EXPECT_EQ(run.summary()["outcome"], "interrupted");
}

TEST(Interrupt, WhileStartingEndsEverything) {
  FlownRun run;
  ASSERT_TRUE(eventually([&] { return run.agents().size() >= 2; }));
  const auto children = children_of(run.launcher().pid());

  run.launcher().signal(SIGINT);

  expect_all_gone_and_summarised(run, children);
}

TEST(Interrupt, InFlightEndsEverything) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto children = children_of(run.launcher().pid());

  run.launcher().signal(SIGINT);

  expect_all_gone_and_summarised(run, children);
}

TEST(Interrupt, EndsAgentsThatDoNotAnswer) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto children = children_of(run.launcher().pid());
  ::kill(run.agents().front(), SIGSTOP);

  run.launcher().signal(SIGINT);

  expect_all_gone_and_summarised(run, children);
}

TEST(EmergencyStop, IsObeyedByEveryRobotAlsoWithoutAPlanner) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  for (const pid_t planner : run.planners())
    ::kill(planner, SIGSTOP);  // dead to the swarm, not restarted

  Program command("swarm_launcher", {"command", run.dir().string(), "stop"});

  EXPECT_EQ(command.wait(), 0) << command.err();
  EXPECT_NE(command.out().find("12 robots confirmed"), std::string::npos) << command.out();
  for (const pid_t planner : run.planners()) ::kill(planner, SIGCONT);
  EXPECT_EQ(run.launcher().wait(), 1);
  EXPECT_EQ(run.summary()["outcome"], "stopped");
  EXPECT_TRUE(run.summary()["stop_latency_ms"]["p99"].is_number());
}

TEST(EmergencyStop, NamesWhoHasNotConfirmed) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const pid_t frozen = run.agents().at(4);
  ::kill(frozen, SIGSTOP);

  Program command("swarm_launcher", {"command", run.dir().string(), "stop"});

  EXPECT_EQ(command.wait(), 1);
  EXPECT_NE(command.out().find("not confirmed by robots 4"), std::string::npos) << command.out();
  ::kill(frozen, SIGCONT);
  EXPECT_EQ(run.launcher().wait(), 1);
}

/// A launcher that hangs when the guard is made and goes on when it goes.
class Suspended {
 public:
  explicit Suspended(const Program& program) : program_(program) { program.signal(SIGSTOP); }
  ~Suspended() { program_.signal(SIGCONT); }
  Suspended(const Suspended&) = delete;
  Suspended& operator=(const Suspended&) = delete;

 private:
  const Program& program_;
};

TEST(EmergencyStop, PassesALauncherThatHangs) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  {
    const Suspended launcher(run.launcher());
    Program command("swarm_launcher", {"command", run.dir().string(), "stop"});
    EXPECT_EQ(command.wait(), 0) << command.err();
    EXPECT_NE(command.out().find("all 12 robots confirmed"), std::string::npos) << command.out();
  }
  EXPECT_EQ(run.launcher().wait(), 1);
  EXPECT_EQ(run.summary()["outcome"], "stopped") << "the launcher takes the stop that it missed";
}

TEST(EmergencyStop, NeedsNoRunDirectory) {
  FlownRun run({"--domain", "226"});
  ASSERT_TRUE(run.mission_started());

  Program command("swarm_launcher", {"command", "--domain", "226", "stop"});

  EXPECT_EQ(command.wait(), 0) << command.err();
  EXPECT_NE(command.out().find("12 robots of domain 226"), std::string::npos) << command.out();
  EXPECT_EQ(run.launcher().wait(), 1);
  EXPECT_EQ(run.summary()["outcome"], "stopped");
}

TEST(EmergencyStop, ReachesAllThroughABadNetwork) {
  FlownRun run({"--fault", "loss=0.5,delay-ms=150,from=6"});  // it begins once all are ready
  ASSERT_TRUE(run.mission_started());
  std::this_thread::sleep_for(std::chrono::seconds(6));

  Program command("swarm_launcher", {"command", run.dir().string(), "stop"});

  EXPECT_EQ(command.wait(), 0) << command.err();
  EXPECT_NE(command.out().find("12 robots confirmed"), std::string::npos) << command.out();
  EXPECT_EQ(run.launcher().wait(), 1);
}

TEST(Command, PausesAndResumes) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());

  Program pause("swarm_launcher", {"command", run.dir().string(), "pause"});
  EXPECT_EQ(pause.wait(), 0) << pause.err();
  Program resume("swarm_launcher", {"command", run.dir().string(), "resume"});
  EXPECT_EQ(resume.wait(), 0) << resume.err();

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
}

}  // namespace
}  // namespace swarm::test
