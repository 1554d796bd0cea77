// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Requests of users, and what the script changes.
#include "tests/unit/swarm_launcher/flight/flight_bench.hpp"

namespace swarm::launcher {
namespace {

class FlightLoopRequest : public FlightBench {
 protected:
  /// The answer to a request, a second later.
  std::string answer_to(const std::string& line) {
    const auto client = requests.send(line);
    run_for(seconds(1));
    return requests.answer_to(client);
  }
  /// The newest scene that was published.
  link::SceneMessage published() {
    std::vector<link::SceneMessage> scenes;
    others.scenes->take(scenes);
    return scenes.empty() ? link::SceneMessage{} : scenes.back();
  }
};

TEST_F(FlightLoopRequest, PausesAndResumes) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  EXPECT_EQ(answer_to("pause"), "done: 3 robots confirmed the pause");
  EXPECT_EQ(loop->supervisor().phase(), MissionPhase::kPaused);
  EXPECT_EQ(answer_to("resume"), "done: 3 robots confirmed the resume");
  EXPECT_EQ(loop->supervisor().phase(), MissionPhase::kRunning);
}

TEST_F(FlightLoopRequest, CountsRobotsThatDoNotConfirmAPause) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  robots[1].silent = true;
  const auto client = requests.send("pause");
  run_for(Confirmations::kTimeout - milliseconds(100));
  EXPECT_EQ(requests.answer_to(client), "");
  run_for(milliseconds(200));
  EXPECT_EQ(requests.answer_to(client),
            "failed: only 2 of 3 robots confirmed the pause within 5 s");
}

/// A participant that is no robot.
struct StatusForger {
  explicit StatusForger(link::InprocBus& bus)
      : participant(bus.make_participant()),
        statuses(*participant->make_writer(link::status_topic())) {}
  /// In the name of a robot that obeys a command.
  void confirm(std::uint32_t robot, RobotMode mode, std::uint64_t command, UtcTime now) {
    statuses->write({.first_robot_id = robot,
                     .plan_version = 1,
                     .command_id = command,
                     .stamp_utc_ns = now.time_since_epoch().count(),
                     .robots = {{.robot_id = robot, .mode = mode, .x_m = 5, .y_m = 5}}});
  }
  std::unique_ptr<link::Participant> participant;
  link::WriterPtr<link::StatusMessage> statuses;
};

TEST_F(FlightLoopRequest, IsNotConfirmedByAForgedStatus) {
  for (const char* request : {"pause", "stop"}) {
    SCOPED_TRACE(request);
    ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
    robots[1].silent = true;  // it hangs
    StatusForger forger(bus);
    const auto client = requests.send(request);
    const RobotMode mode =
        request == std::string("pause") ? RobotMode::kHolding : RobotMode::kStopped;
    const std::uint64_t before = loop->measurements().refused_by_launcher;
    for (int i = 0; i < 300; ++i) {  // 6 s
      step();
      if (!commands.empty()) forger.confirm(1, mode, commands.back().command_id, now.utc);
    }
    const std::string answer = requests.answer_to(client);
    EXPECT_TRUE(answer == "failed: only 2 of 3 robots confirmed the pause within 5 s" ||
                answer == "failed: stop not confirmed by robots 1")
        << answer;
    EXPECT_GT(loop->measurements().refused_by_launcher, before + 100);
    EXPECT_TRUE(is_logged("refused"));
    robots[1].silent = false;
    requests.send("resume");
    run_for(seconds(2));  // it is received again, so that no other sender is followed
  }
}

TEST_F(FlightLoopRequest, IsNotConfirmedByARobotThatStoppedForAnotherCommand) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  robots[1].mode = RobotMode::kStopped;  // by itself
  robots[1].ignores_stop = true;
  const auto client = requests.send("stop");
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(requests.answer_to(client), "failed: stop not confirmed by robots 1");
}

TEST_F(FlightLoopRequest, IsConfirmedByTheNextProcessOfARobot) {
  options.mission.launcher.respawn_agent_max = 1;
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  spawner.end(spawner.agent(1), {.signal = 9});
  const auto next = bus.make_participant();
  const auto statuses = *next->make_writer(link::status_topic());
  robots[1].statuses = statuses.get();
  run_for(seconds(2));
  EXPECT_EQ(answer_to("pause"), "done: 3 robots confirmed the pause");
}

TEST_F(FlightLoopRequest, ReportsACommandThatChangesNothing) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  EXPECT_EQ(answer_to("resume"), "done: resume sent; it changes nothing, the mission is running");
}

TEST_F(FlightLoopRequest, RefusesAnObstacleOutsideOfTheBounds) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  const std::uint64_t before = published().version;
  EXPECT_EQ(answer_to("add_obstacle circle_m: {center: [-3, 15], radius: 2}"),
            "add_obstacle: the obstacle lies outside of world.bounds_m, [0, 0, 40, 30], where no "
            "robot drives\nfailed: nothing changed");
  EXPECT_EQ(scene->scene().version, before);
  EXPECT_TRUE(answer_to("add_obstacle circle_m: {center: [-1, 15], radius: 2}").starts_with("done"))
      << "it reaches into the bounds";
}

TEST_F(FlightLoopRequest, RefusesAGoalWithoutRoomForTheRobots) {
  options.mission.robots.radius_m = 0.5;
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  const std::string answer = answer_to(
      "goto goal: [{mean_m: [20, 15], covariance_m2: [[0.0001, 0], [0, 0.0001]], weight: 1}]");
  EXPECT_TRUE(answer.starts_with("goto: goal has no room for 3 robots of 0.5 m radius")) << answer;
  EXPECT_TRUE(answer.ends_with("failed: nothing changed")) << answer;
}

TEST_F(FlightLoopRequest, AnswersAStopWhenAllRobotsHaveConfirmed) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  const auto client = requests.send("stop");
  step();
  EXPECT_EQ(requests.answer_to(client), "");

  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(requests.answer_to(client), "done: 3 robots confirmed the stop");
  EXPECT_EQ(outcome(), Outcome::kStopped);
  EXPECT_EQ(sent(CommandKind::kStop), 15U);
}

TEST_F(FlightLoopRequest, AnswersAStopWithTheRobotsThatDidNotConfirm) {
  robots[1].ignores_stop = true;
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  const auto client = requests.send("stop");
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(requests.answer_to(client), "failed: stop not confirmed by robots 1");
  EXPECT_TRUE(is_logged("stop-unconfirmed"));
}

TEST_F(FlightLoopRequest, StopsBeforeTheStart) {
  robots[2].silent = true;
  run_for(seconds(1));
  const auto client = requests.send("stop");
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(requests.answer_to(client), "failed: stop not confirmed by robots 2");
  EXPECT_EQ(sent(CommandKind::kStart), 0U);
}

TEST_F(FlightLoopRequest, RefusesAStopWhenTheRunIsEnding) {
  spawner.obedient = false;
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  loop->interrupt();
  run_for(milliseconds(100));
  const auto client = requests.send("stop");
  step();
  EXPECT_EQ(requests.answer_to(client), "failed: the run is ending, no stop was sent");
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(sent(CommandKind::kStop), 0U);
  EXPECT_EQ(outcome(), Outcome::kInterrupted);
}

TEST_F(FlightLoopRequest, PublishesAnAcceptedChangeOfTheScene) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  EXPECT_EQ(answer_to("add_obstacle circle_m: {center: [30, 15], radius: 1}"),
            "done: obstacle 2 added");
  const link::SceneMessage scene_now = published();
  EXPECT_EQ(scene_now.version, scene->scene().version);
  EXPECT_EQ(scene_now.obstacles.size(), 1U);
  EXPECT_TRUE(is_logged("scene"));
}

TEST_F(FlightLoopRequest, RefusesAChangeOfTheSceneAndChangesNothing) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  const std::uint64_t before = published().version;
  const std::string answer = answer_to("remove_obstacle obstacle: 99");
  EXPECT_NE(answer.find("there is no obstacle 99"), std::string::npos) << answer;
  EXPECT_TRUE(answer.ends_with("failed: nothing changed")) << answer;
  EXPECT_EQ(scene->scene().version, before);
  EXPECT_TRUE(is_logged("scene-refused"));
}

TEST_F(FlightLoopRequest, RefusesBodiesOfUsersAndUnknownRequests) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  for (const char* line :
       {"add_body robot: 1, circle_m: {center: [30, 15], radius: 1}", "fly", ""}) {
    EXPECT_TRUE(answer_to(line).ends_with("failed: nothing changed")) << line;
  }
}

TEST_F(FlightLoopRequest, CountsArrivalForTheNewestGoalOnly) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  arrive();
  run_for(milliseconds(500));
  EXPECT_EQ(loop->supervisor().counts().arrived, kRobots);
  const auto client =
      requests.send("goto goal: [{mean_m: [20, 15], covariance_m2: [[4, 0], [0, 4]], weight: 1}]");
  step();
  EXPECT_EQ(requests.answer_to(client), "done: goto");
  EXPECT_EQ(loop->supervisor().counts().arrived, 0U);
}

TEST_F(FlightLoopRequest, DisplaysAChangeOfTheScriptThatIsRefused) {
  options.mission.script = {{1.0, SceneChange(RemoveObstacle{99})}};
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  run_for(seconds(2));
  EXPECT_NE(display.printed.find("the script's change was refused: there is no obstacle 99"),
            std::string::npos);
  EXPECT_TRUE(is_logged("scene-refused"));
}

TEST_F(FlightLoopRequest, PrintsMessagesOfHelpersOnce) {
  helpers.next_message = "view: http://127.0.0.1:8000/";
  run_for(seconds(1));
  EXPECT_EQ(display.printed, "view: http://127.0.0.1:8000/\n");
}

}  // namespace
}  // namespace swarm::launcher
