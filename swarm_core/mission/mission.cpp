// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/mission/mission.hpp"

#include <algorithm>

#include "swarm_core/base/assert.hpp"

namespace swarm {

// Groups take the ids from 0 in order; the robots after the last group have the common body.
const BodySpec& body_of(const RobotsSpec& robots, RobotId robot) {
  SWARM_ASSERT(robot.value() < robots.count);
  std::uint32_t first = 0;
  for (const RobotGroupSpec& group : robots.groups) {
    if (robot.value() - first < group.count) return group;
    first += group.count;
  }
  return robots;
}

// The common body counts only if some robots are in no group.
double largest_radius_m(const RobotsSpec& robots) {
  double largest_m = 0.0;
  std::uint32_t grouped = 0;
  for (const RobotGroupSpec& group : robots.groups) {
    largest_m = std::max(largest_m, group.radius_m);
    grouped += group.count;
  }
  return grouped < robots.count ? std::max(largest_m, robots.radius_m) : largest_m;
}

double largest_speed_mps(const RobotsSpec& robots) {
  double largest = robots.speed_max_mps;
  for (const RobotGroupSpec& group : robots.groups) {
    largest = std::max(largest, group.speed_max_mps);
  }
  return largest;
}

// A radius of 0 stands for the mission's own radius, so taking the maximum needs no special case.
double largest_communication_radius_m(const Mission& mission) {
  double largest_m = mission.robots.communication_radius_m;
  for (const RobotGroupSpec& group : mission.robots.groups) {
    largest_m = std::max(largest_m, group.communication_radius_m);
  }
  return std::max(largest_m, mission.link.communication_radius_m);
}

}  // namespace swarm
