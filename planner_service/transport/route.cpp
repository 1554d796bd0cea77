// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/transport/route.hpp"

#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {

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

}  // namespace swarm::planner
