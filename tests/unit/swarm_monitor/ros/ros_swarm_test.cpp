// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/ros/ros_swarm.hpp"

#include <chrono>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace swarm::monitor {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr UtcTime kNow{seconds(1000)};

/// Three robots, and a table in a room of 6 x 4 m.
Mission room() {
  Mission mission;
  mission.name = "room";
  mission.world =
      *World::make({{-1, -2}, {5, 2}}, {*Polygon::make({{1, 0}, {2, 0}, {2, 1}, {1, 1}})});
  mission.robots.count = 3;
  mission.robots.radius_m = 0.25;
  return mission;
}

class RosSwarmTest : public ::testing::Test {
 protected:
  RosSwarmTest() { sut_.on_mission(room()); }

  void state(std::uint32_t robot, const Vec2& position_m, const Vec2& velocity_mps,
             RobotMode mode = RobotMode::kMoving) {
    sut_.on_state({.robot = RobotId(robot),
                   .received = kNow,
                   .position_m = position_m,
                   .velocity_mps = velocity_mps,
                   .mode = mode});
  }
  const ros::DiagnosticStatus& status_of(const std::string& name) {
    last_ = sut_.diagnostics(kNow + seconds(1));
    for (const ros::DiagnosticStatus& status : last_.status) {
      if (status.name == name) return status;
    }
    ADD_FAILURE() << name;
    return last_.status.front();
  }

  RosSwarm sut_{"map"};
  ros::DiagnosticArray last_;
};

TEST_F(RosSwarmTest, PosesAreThoseOfKnownRobotsMovedOnToNow) {
  EXPECT_TRUE(sut_.poses(kNow).poses.empty());
  state(0, {1, 1}, {0, 2});
  state(2, {3, 1}, {0, 0});
  const ros::PoseArray array = sut_.poses(kNow + milliseconds(250));
  EXPECT_EQ(array.header.frame_id, "map");
  EXPECT_EQ(array.header.stamp, (ros::Time{.sec = 1000, .nanosec = 250'000'000}));
  ASSERT_EQ(array.poses.size(), 2U);
  EXPECT_DOUBLE_EQ(array.poses[0].position.y, 1.5);
  EXPECT_NEAR(array.poses[0].orientation.z, std::sin(std::numbers::pi / 4), 1e-12);
  EXPECT_DOUBLE_EQ(array.poses[1].position.x, 3.0);
  // After half a second without a state it may have stopped.
  EXPECT_DOUBLE_EQ(sut_.poses(kNow + seconds(9)).poses[0].position.y, 2.0);
}

TEST_F(RosSwarmTest, AStatusCountsWhereStatesAreOld) {
  state(0, {1, 1}, {0, 2});
  sut_.on_status({.robot = RobotId(0), .received = kNow + milliseconds(100), .position_m = {9, 9}});
  EXPECT_DOUBLE_EQ(sut_.poses(kNow).poses[0].position.x, 1.0);
  sut_.on_status({.robot = RobotId(0), .received = kNow + seconds(2), .position_m = {4, 1}});
  EXPECT_DOUBLE_EQ(sut_.poses(kNow + seconds(3)).poses[0].position.x, 4.0);
}

TEST_F(RosSwarmTest, IgnoresRobotsThatTheMissionDoesNotHave) {
  state(3, {1, 1}, {0, 0});
  sut_.on_status({.robot = RobotId(99), .received = kNow});
  EXPECT_TRUE(sut_.poses(kNow).poses.empty());
}

TEST_F(RosSwarmTest, MarkersAreOneListOfRobotsAndAnEllipseOfEachGaussian) {
  state(0, {1, 1}, {0, 0}, RobotMode::kArrived);
  EXPECT_EQ(sut_.markers(kNow, milliseconds(500)).markers.size(), 1U) << "no plan yet";
  const Eigen::Rotation2Dd turn(std::numbers::pi / 6);
  const Mat2 covariance = turn * Vec2(4.0, 0.25).asDiagonal() * turn.inverse();
  const Gaussian g = *Gaussian::make({2, 0}, covariance);
  const FlowPlan plan =
      *FlowPlan::make({{g, MissionTime(0), 1.0}, {g, MissionTime(5), 1.0}}, {{0, 1, 1.0}});
  sut_.on_plan({.flow = plan, .version = 1});
  sut_.on_clock({.phase = MissionPhase::kRunning, .plan_time_s = 2.0});

  const auto markers = sut_.markers(kNow, milliseconds(500)).markers;
  ASSERT_EQ(markers.size(), 2U);
  EXPECT_EQ(markers[0].points.size(), 1U);
  EXPECT_EQ(markers[0].colors.size(), 1U);
  EXPECT_DOUBLE_EQ(markers[0].scale.x, 0.5);
  EXPECT_GT(markers[0].colors[0].g, markers[0].colors[0].r) << "arrived is green";
  EXPECT_NEAR(markers[1].scale.x, 4.0, 1e-9) << "the longer axis first";
  EXPECT_NEAR(markers[1].scale.y, 1.0, 1e-9);
  const double angle_rad =
      2.0 * std::atan2(markers[1].pose.orientation.z, markers[1].pose.orientation.w);
  EXPECT_NEAR(std::remainder(angle_rad - std::numbers::pi / 6, std::numbers::pi), 0.0, 1e-9);
}

TEST_F(RosSwarmTest, TheMapHasTheObstaclesOfTheScene) {
  EXPECT_EQ(sut_.cells(0.5), 12.0 * 8.0);
  const std::uint64_t version = sut_.map_version(kNow);
  const ros::OccupancyGrid grid = sut_.map(0.5, kNow);
  ASSERT_EQ(grid.info.width, 12U);
  ASSERT_EQ(grid.info.height, 8U);
  EXPECT_EQ(grid.info.origin.position.x, -1.0);
  const auto cell = [&](const ros::OccupancyGrid& g, double x, double y) {
    const auto column = static_cast<std::size_t>((x - g.info.origin.position.x) / 0.5);
    const auto row = static_cast<std::size_t>((y - g.info.origin.position.y) / 0.5);
    return g.data.at(row * g.info.width + column);
  };
  EXPECT_EQ(cell(grid, 1.25, 0.25), 100);
  EXPECT_EQ(cell(grid, 1.25, -0.25), 0);
  EXPECT_EQ(std::ranges::count(grid.data, std::int8_t{100}), 4);
  EXPECT_EQ(sut_.map_version(kNow), version);

  Scene scene = first_scene(1);
  scene.version = 1;
  const auto changed = after(scene, AddObstacle{Circle{{4, -1}, 0.6}}, room().world, kNow);
  ASSERT_TRUE(changed.has_value());
  sut_.on_scene(*changed);
  EXPECT_GT(sut_.map_version(kNow), version);
  EXPECT_EQ(cell(sut_.map(0.5, kNow), 4.2, -0.8), 100);
}

TEST_F(RosSwarmTest, DiagnosticsNameWhoIsNotReceivedAndWhoHolds) {
  sut_.on_status({.robot = RobotId(0), .received = kNow, .mode = RobotMode::kMoving});
  sut_.on_status({.robot = RobotId(1), .received = kNow, .mode = RobotMode::kHolding});
  EXPECT_EQ(status_of("swarmflow: robot 0").level, 0);
  EXPECT_EQ(status_of("swarmflow: robot 1").level, 1);
  EXPECT_EQ(status_of("swarmflow: robot 2").level, 3);
  EXPECT_EQ(status_of("swarmflow: mission").level, 0);
  EXPECT_EQ(last_.status.size(), 4U);
  sut_.on_event({.received = kNow,
                 .source = "robot-1",
                 .severity = "warning",
                 .code = "robot-fault",
                 .text = "no position"});
  EXPECT_EQ(status_of("swarmflow: mission").message, "robot-1: no position");
  EXPECT_EQ(status_of("swarmflow: mission").level, 1);
  EXPECT_EQ(sut_.diagnostics(kNow + seconds(11)).status[0].message, "ready") << "it was then";
  const auto later = sut_.diagnostics(kNow + seconds(4));
  EXPECT_EQ(later.status[1].level, 3);
  EXPECT_EQ(later.status[1].message, "no status for 4 s");
}

}  // namespace
}  // namespace swarm::monitor
