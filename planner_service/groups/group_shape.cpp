// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/groups/group_shape.hpp"

#include <algorithm>
#include <cmath>

namespace swarm::planner {

// Maximum-likelihood covariance (divided by n) plus the floor.
Gaussian shape_of(const Members& members, double sigma_floor_m) {
  Vec2 mean_m = Vec2::Zero();
  for (const ReportedRobot* robot : members) mean_m += robot->position_m;
  mean_m /= static_cast<double>(members.size());
  Mat2 covariance_m2 = Mat2::Zero();
  for (const ReportedRobot* robot : members) {
    const Vec2 offset_m = robot->position_m - mean_m;
    covariance_m2 += offset_m * offset_m.transpose();
  }
  covariance_m2 /= static_cast<double>(members.size());
  return Gaussian::from_valid(mean_m,
                              covariance_m2 + sigma_floor_m * sigma_floor_m * Mat2::Identity());
}

// Direction of the larger principal axis of a 2 × 2 covariance: half the angle of its deviator.
void sort_along_axis(Members& members, const Gaussian& gaussian) {
  const Mat2& c = gaussian.covariance_m2();
  const double angle_rad = 0.5 * std::atan2(2.0 * c(0, 1), c(0, 0) - c(1, 1));
  const Vec2 axis(std::cos(angle_rad), std::sin(angle_rad));
  std::stable_sort(members.begin(), members.end(),
                   [&](const ReportedRobot* a, const ReportedRobot* b) {
                     return axis.dot(a->position_m) < axis.dot(b->position_m);
                   });
}

std::vector<RobotId> ids_of(const Members& members) {
  std::vector<RobotId> ids;
  ids.reserve(members.size());
  for (const ReportedRobot* robot : members) ids.push_back(robot->robot);
  return ids;
}

}  // namespace swarm::planner
