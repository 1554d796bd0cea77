// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/fallen_robots.hpp"

#include <array>
#include <optional>
#include <variant>

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

  std::optional<LastKnown> in_log_;
  FallenRobots sut_{options.mission,
                    *scene,
                    *log,
                    kRobots - 1,  // the last one is on another host
                    milliseconds(300),
                    [this](RobotId) { return in_log_; }};
};

// Of a robot on another host only the last status is known at first.
TEST_F(FallenRobotsTest, NarrowABodyOnceTheEndOfItsLogIsKnown) {
  const std::array fallen{RobotId(1)};
  sut_.on_status(RobotId(1), {.at = now.utc, .position_m = {8, 12}});
  sut_.add(fallen, now.utc + seconds(1));
  ASSERT_TRUE(body_of(RobotId(1)));
  EXPECT_GE(body_of(RobotId(1))->radius_m, 2.0);

  in_log_ = {.at = now.utc + milliseconds(500),
             .position_m = {8.5, 12},
             .command_mps = Vec2::Zero(),
             .speed_mps = 0.0,
             .is_last = true};
  sut_.narrow(fallen, now.utc + seconds(20));

  EXPECT_EQ(body_of(RobotId(1))->center_m, Vec2(8.5, 12));
  EXPECT_DOUBLE_EQ(body_of(RobotId(1))->radius_m, options.mission.robots.radius_m);
  EXPECT_TRUE(is_logged("body-narrowed"));
}

// A full disk. Audits have bodies where the logs end.
TEST_F(FallenRobotsTest, AreReportedWhereALogOnThisHostLacksItsEnd) {
  in_log_ = {.at = now.utc, .position_m = {8, 12}, .command_mps = Vec2(1, 0), .speed_mps = 1.0};
  for (const std::uint32_t robot : {0U, 2U}) {
    sut_.on_status(RobotId(robot), {.at = now.utc + milliseconds(300), .position_m = {8.3, 12}});
    sut_.add(std::array{RobotId(robot)}, now.utc + seconds(1));
    EXPECT_FALSE(is_logged("log-incomplete")) << robot;
  }
  sut_.on_status(RobotId(2), {.at = now.utc + milliseconds(301), .position_m = {8.3, 12}});
  sut_.add(std::array{RobotId(2)}, now.utc + seconds(1));
  EXPECT_FALSE(is_logged("log-incomplete")) << "its log is on another host";

  sut_.on_status(RobotId(0), {.at = now.utc + milliseconds(301), .position_m = {8.3, 12}});
  sut_.add(std::array{RobotId(0)}, now.utc + seconds(1));

  EXPECT_TRUE(is_logged("log-incomplete"));
}

TEST_F(FallenRobotsTest, NarrowNoBodyThatIsNoneOrWouldGrow) {
  const std::array fallen{RobotId(1)};
  in_log_ = {.at = now.utc, .position_m = {8, 12}, .command_mps = Vec2(1, 0), .speed_mps = 1.0};
  sut_.narrow(fallen, now.utc);
  EXPECT_FALSE(body_of(RobotId(1)));

  sut_.add(fallen, now.utc);
  const std::uint64_t version = scene->scene().version;
  sut_.narrow(fallen, now.utc + seconds(5));

  EXPECT_EQ(scene->scene().version, version) << "the older, the wider";
}

}  // namespace
}  // namespace swarm::launcher
