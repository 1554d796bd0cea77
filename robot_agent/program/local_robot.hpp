// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "robot_agent/inbox.hpp"
#include "robot_agent/loop/robot_loop.hpp"
#include "robot_agent/program/log_file.hpp"
#include "swarm_core/app/file_thread.hpp"
#include "swarm_core/app/shared_steps.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/robot/driver.hpp"
#include "swarmflow/robot/run_robot.hpp"

namespace swarm::agent {

/// One robot of a process: its control loop and what the loop works with.
struct LocalRobot {
  RobotLoop loop;
  std::unique_ptr<Driver> driver;
  Rng rng;
  LogFile log;
  EchoGuard echo{};  ///< of the states it published
};

/// Which robots a process flies, and where their steps are recorded.
struct LocalRobotsSpec {
  shell::FileThread& files;             ///< writes the logs
  shell::SharedSteps* steps = nullptr;  ///< with a place for each robot; null: there is none
  std::filesystem::path run_dir;
  RobotId first;
  std::uint32_t count = 1;
  std::uint64_t seed = 1;  ///< of the run
  SteadyTime now;
  UtcTime utc_now;
};

/// The robots of a process.
struct LocalRobots {
  std::vector<LocalRobot> robots;
  bool any_is_underway = false;  ///< some were restarted in mid-flight
  bool read_density = false;     ///< their control method reads the planned density
};

/// Makes robots at their positions in the mission, or at the last ones recorded, with the
/// control method and the drivers that the mission names, begins their logs and starts their
/// drivers. Fails where robots cannot be placed, the registry lacks a name, or a driver does not
/// start; a log that cannot be written or read does not keep a robot from flying. \pre the world
/// outlives them
Result<LocalRobots> make_local_robots(const Mission& mission, const World& world,
                                      const RobotRegistry& registry, const LocalRobotsSpec& spec);

}  // namespace swarm::agent
