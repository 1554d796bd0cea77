// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/fault_injector.hpp"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "swarm_core/robot_log/robot_log_file.hpp"

namespace swarm::launcher {
namespace {

TEST(FaultInjector, KeepsObstaclesAwayFromWhereRobotLogsEnd) {
  const auto run_dir = std::filesystem::temp_directory_path() /
                       ("fault_injector_test_" + std::to_string(::getpid()));
  EXPECT_TRUE(is_clear_of_robots(run_dir, {10, 10}, 5.0)) << "no robot has a log yet";

  for (const std::uint32_t robot : {0U, 7U}) {
    auto log = robot_log::Writer::open(robot_log::file_of(run_dir, RobotId(robot)));
    ASSERT_TRUE(log.has_value());
    log->append(robot_log::Header{.robot = RobotId(robot), .robots = 8, .radius_m = 0.2});
    log->append(robot_log::Step{.position_m = {10, 10}});
    log->append(robot_log::Step{.position_m = {20.0 + robot, 10}});
  }

  EXPECT_TRUE(is_clear_of_robots(run_dir, {10, 10}, 5.0)) << "they have left";
  EXPECT_FALSE(is_clear_of_robots(run_dir, {20, 14.9}, 5.0));
  EXPECT_FALSE(is_clear_of_robots(run_dir, {31.9, 10}, 5.0));
  EXPECT_TRUE(is_clear_of_robots(run_dir, {32.1, 10}, 5.0));
  std::filesystem::remove_all(run_dir);
}

}  // namespace
}  // namespace swarm::launcher
