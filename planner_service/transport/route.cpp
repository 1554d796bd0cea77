// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/transport/route.hpp"

#include <algorithm>
#include <cmath>

#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

constexpr double kShortestLeg_s = 1e-3;

}  // namespace

double w2_length_m(const Waypoints& waypoints) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    length_m += wasserstein2(waypoints[i - 1], waypoints[i]);
  }
  return length_m;
}

double mean_length_m(const Waypoints& waypoints) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    length_m += (waypoints[i].mean_m() - waypoints[i - 1].mean_m()).norm();
  }
  return length_m;
}

double leg_duration_s(const Gaussian& from, const Gaussian& to, double speed_mps) {
  const double mean_way_m = (to.mean_m() - from.mean_m()).norm();
  const double squared = wasserstein2_squared(from, to);
  const double shape_way_m = std::sqrt(std::max(0.0, squared - mean_way_m * mean_way_m));
  return std::max(std::max(mean_way_m, shape_way_m) / speed_mps, kShortestLeg_s);
}

}  // namespace swarm::planner
