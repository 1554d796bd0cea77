// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/fallen_robots.hpp"

#include <array>
#include <optional>
#include <variant>

#include "swarm_core/mission/scene_bodies.hpp"
#include "tests/unit/swarm_launcher/flight/flight_bench.hpp"

namespace swarm::launcher {
namespace {

class FallenRobotsTest : public FlightBench {
 protected:
  FallenRobotsTest() { begin(); }
  std::optional<Circle> body_of(RobotId robot) const {
    for (const SceneObstacle& obstacle : scene->scene().obstacles) {
      if (obstacle.owner == robot) return std::get<Circle>(obstacle.shape);
    }
    return std::nullopt;
  }

  std::optional<LastKnown> last_step_;
  std::optional<LastKnown> in_log_;
  std::optional<Duration> runs_for_;  // empty: it has ended
  FallenRobots sut_{options.mission,
                    *scene,
                    *log,
                    {.robots = kRobots - 1,  // the last one is on another host
                     .log_delay = milliseconds(300),
                     .runs_for = [this](RobotId, SteadyTime) { return runs_for_; }},
                    {.last_step = [this](RobotId) { return last_step_; },
                     .in_log = [this](RobotId) { return in_log_; }}};

  static constexpr RobotId kHere{0};
  static constexpr RobotId kElsewhere{kRobots - 1};
  double radius_m(RobotId robot) const { return body_of(robot).value().radius_m; }
  double smallest_m() const { return options.mission.robots.radius_m; }
  FlightTime later(Duration by) const { return {.steady = now.steady + by, .utc = now.utc + by}; }
  /// Later by this, with the step that the robot makes then.
  void look_again(Duration later, const std::optional<LastKnown>& step = {}) {
    now.steady += later;
    now.utc += later;
    if (step) {
      last_step_ = step;
      last_step_->at = now.utc;
    }
    sut_.update(now);
  }
};

const LastKnown kStanding{.position_m = {8.5, 12}, .command_mps = Vec2::Zero(), .speed_mps = 0.0};
const LastKnown kDriving{.position_m = {8.5, 12}, .command_mps = Vec2(1, 0), .speed_mps = 1.0};

// Of a robot on another host only the last status is known at first.
TEST_F(FallenRobotsTest, HaveASmallerBodyOnceTheirLastStepIsKnown) {
  sut_.on_status(kElsewhere, {.at = now.utc, .position_m = {8, 12}});
  sut_.add(std::array{kElsewhere}, later(seconds(1)));
  ASSERT_TRUE(body_of(kElsewhere));
  EXPECT_GE(radius_m(kElsewhere), 2.0);

  look_again(seconds(20));
  EXPECT_GE(radius_m(kElsewhere), 2.0);
  last_step_ = kStanding;
  last_step_->is_last = true;  // as its host reports
  look_again(seconds(1), last_step_);

  EXPECT_EQ(body_of(kElsewhere)->center_m, Vec2(8.5, 12));
  EXPECT_DOUBLE_EQ(radius_m(kElsewhere), smallest_m());
  EXPECT_TRUE(is_logged("body-changed"));
  EXPECT_TRUE(is_logged("last-step"));
}

// Its host reports a step, and not that it is the last one.
TEST_F(FallenRobotsTest, MayHaveDrivenOnFromAStepOnAnotherHost) {
  last_step_ = kDriving;
  last_step_->at = now.utc;

  sut_.add(std::array{kElsewhere}, later(seconds(3)));

  EXPECT_GT(radius_m(kElsewhere), frozen_body_radius_m(options.mission, kElsewhere));
}

// It runs, but nothing of it is received: it drives on until it holds, as the planner is silent.
TEST_F(FallenRobotsTest, ThatMakeStepsHaveAWideBodyUntilTheyStand) {
  runs_for_ = seconds(20);
  last_step_ = kDriving;
  last_step_->at = now.utc;
  sut_.add(std::array{kHere}, now);
  const double holds_m =
      options.mission.timing.planner_silence_s * options.mission.robots.speed_max_mps;
  EXPECT_GE(radius_m(kHere), smallest_m() + holds_m);

  look_again(milliseconds(1100), kDriving);
  EXPECT_GE(radius_m(kHere), smallest_m() + holds_m);
  look_again(milliseconds(1100), kStanding);
  EXPECT_DOUBLE_EQ(radius_m(kHere), smallest_m());

  LastKnown elsewhere = kDriving;
  elsewhere.position_m = {14, 12};
  look_again(milliseconds(1100), elsewhere);
  EXPECT_EQ(body_of(kHere)->center_m, Vec2(14, 12)) << "it moves again, and is not received";
  EXPECT_GE(radius_m(kHere), smallest_m() + holds_m);
}

TEST_F(FallenRobotsTest, ThatAreFrozenHaveABodyWhereTheyMadeTheirLastStep) {
  runs_for_ = seconds(20);
  last_step_ = kDriving;
  last_step_->at = now.utc - seconds(3);
  sut_.add(std::array{kHere}, now);
  const std::uint64_t version = scene->scene().version;

  EXPECT_NEAR(radius_m(kHere), smallest_m() + 0.1, 1e-9) << "half of two periods at 1 m/s";
  look_again(seconds(5));
  EXPECT_EQ(scene->scene().version, version) << "nothing has changed";
}

// A full disk: the log and the statuses end before the last step.
TEST_F(FallenRobotsTest, AreWhereTheirLastStepIsThoughTheirLogEndsEarlier) {
  in_log_ = {.at = now.utc, .position_m = {8, 12}, .command_mps = Vec2(1, 0), .speed_mps = 1.0};
  last_step_ = kStanding;
  last_step_->at = now.utc + seconds(4);
  last_step_->position_m = {12, 12};
  sut_.on_status(RobotId(0), {.at = now.utc + seconds(3), .position_m = {11, 12}});

  sut_.add(std::array{RobotId(0)}, later(seconds(9)));

  ASSERT_TRUE(body_of(RobotId(0)));
  EXPECT_EQ(body_of(RobotId(0))->center_m, Vec2(12, 12));
  EXPECT_DOUBLE_EQ(radius_m(RobotId(0)), smallest_m());
  EXPECT_TRUE(is_logged("log-incomplete"));
}

// A full disk. Audits have bodies where the logs end.
TEST_F(FallenRobotsTest, AreReportedWhereALogOnThisHostLacksItsEnd) {
  in_log_ = {.at = now.utc, .position_m = {8, 12}, .command_mps = Vec2(1, 0), .speed_mps = 1.0};
  for (const std::uint32_t robot : {0U, 2U}) {
    sut_.on_status(RobotId(robot), {.at = now.utc + milliseconds(300), .position_m = {8.3, 12}});
    sut_.add(std::array{RobotId(robot)}, later(seconds(1)));
    EXPECT_FALSE(is_logged("log-incomplete")) << robot;
  }
  sut_.on_status(RobotId(2), {.at = now.utc + milliseconds(301), .position_m = {8.3, 12}});
  sut_.add(std::array{RobotId(2)}, later(seconds(1)));
  EXPECT_FALSE(is_logged("log-incomplete")) << "its log is on another host";

  sut_.on_status(RobotId(0), {.at = now.utc + milliseconds(301), .position_m = {8.3, 12}});
  runs_for_ = seconds(100);
  sut_.add(std::array{RobotId(0)}, later(seconds(1)));
  EXPECT_TRUE(is_logged("log-incomplete"));
  EXPECT_TRUE(log->losses().empty()) << "a frozen process may write the rest later";

  runs_for_.reset();
  sut_.add(std::array{RobotId(0)}, later(seconds(1)));

  ASSERT_EQ(log->losses().size(), 1U);
  EXPECT_EQ(log->losses()[0], "robot 0: the last 0.3 s of the log of a process that ended");
}

// The scene holds a limited number of obstacles.
TEST_F(FallenRobotsTest, WaitForRoomInTheScene) {
  for (std::size_t i = 0; i < Scene::kMaxObstacles; ++i) {
    ASSERT_TRUE(scene->change(AddObstacle{Circle{{5, 5}, 0.1}}, now.utc));
  }
  last_step_ = kStanding;
  last_step_->at = now.utc;
  sut_.add(std::array{kHere}, now);
  EXPECT_FALSE(body_of(kHere));
  EXPECT_TRUE(is_logged("body-refused"));
  EXPECT_FALSE(is_logged("body-added"));
  look_again(seconds(2));
  EXPECT_FALSE(body_of(kHere));

  const auto added = static_cast<std::uint32_t>(options.mission.world.obstacles().size());
  ASSERT_TRUE(scene->change(RemoveObstacle{added}, now.utc));
  look_again(seconds(2));

  EXPECT_TRUE(body_of(kHere));
}

// Its process was killed, and started again at once.
TEST_F(FallenRobotsTest, ThatHaveNotMadeAStepSinceTheirRestartHaveABodyWhereTheLastOneWas) {
  runs_for_ = milliseconds(50);
  last_step_ = kDriving;
  last_step_->at = now.utc - milliseconds(80);

  sut_.add(std::array{kHere}, now);

  EXPECT_NEAR(radius_m(kHere), smallest_m() + 0.1, 1e-9);
  look_again(seconds(2), kDriving);
  EXPECT_NEAR(radius_m(kHere), smallest_m() + 0.1, 1e-9) << "its first status is under way";
}

TEST_F(FallenRobotsTest, AreLookedAtOnceASecond) {
  runs_for_ = seconds(20);
  last_step_ = kDriving;
  last_step_->at = now.utc;
  sut_.update(now);
  sut_.add(std::array{kHere}, now);

  look_again(milliseconds(900), kStanding);
  EXPECT_GT(radius_m(kHere), smallest_m());
  look_again(milliseconds(200), kStanding);
  EXPECT_DOUBLE_EQ(radius_m(kHere), smallest_m());
}

TEST_F(FallenRobotsTest, ThatAreClearedHaveNoBodyAgain) {
  last_step_ = kStanding;
  last_step_->at = now.utc;
  sut_.add(std::array{kHere}, now);
  sut_.clear(std::array{kHere}, now.utc);

  look_again(seconds(2), kDriving);

  EXPECT_FALSE(body_of(kHere));
}

}  // namespace
}  // namespace swarm::launcher
