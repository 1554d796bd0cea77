// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbours/silent_neighbours.hpp"

#include "robot_agent/neighbours/neighbour_table.hpp"

namespace swarm::agent {
namespace {

/// A robot less deep than this in a disc is on its surface: it can outrun it, but for rounding and
/// the time between two ticks.
constexpr double kOnSurface_m = 0.05;

}  // namespace

void find_silent_neighbours(const SilentRobots& robots, const NeighbourOptions& options,
                            const Vec2& own_position_m, SilentNeighbours& found) {
  found.clear();
  for (const SilentRobot& silent : robots.all()) {
    const Vec2 offset_m = own_position_m - silent.centre_m;
    const double distance_m = offset_m.norm();
    if (distance_m < silent.radius_m + options.radius_m - options.scale * kOnSurface_m) {
      found.clear();
      found.is_within = true;
      return;
    }
    const double grown_m = silent.radius_m - options.fleet.of(silent.robot).radius_m;
    if (distance_m - grown_m > options.reach_m) continue;
    (distance_m - grown_m <= options.close_m ? found.close : found.far)
        .push_back({.robot = silent.robot,
                    .position_m = silent.centre_m,
                    .velocity_mps = silent.growth_mps / distance_m * offset_m,
                    .radius_m = silent.radius_m,
                    .information_age_s = to_seconds(options.period),
                    .is_silent = true});
  }
}

}  // namespace swarm::agent
