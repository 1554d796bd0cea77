// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "planner_service/methods/crops/crops_guide.hpp"
#include "swarmflow/mission/mission_file.hpp"

/// Worlds for guides, and measures of their paths.
namespace swarm::planner {

inline Polygon box(double x0, double y0, double x1, double y1) {
  return Polygon::make({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}).value();
}

inline Mixture single(double x, double y, double sigma_m) {
  return Mixture::make({{1.0, Gaussian::from_parameters({x, y}, sigma_m, sigma_m, 0.0)}}).value();
}

inline Mission crops_scene(const std::string& name) {
  return load_mission(std::string(SWARM_SOURCE_DIR) + "/deploy/missions/crops_" + name + ".yaml")
      .value();
}

inline Result<CropsGuide> guide_of(const Mission& mission, std::uint64_t seed) {
  Rng rng(seed);
  return CropsGuide::make(mission.world, mission.start, mission.goal, {}, {}, rng);
}

// Largest CVaR on the legs, on a grid.
inline double worst_cvar_m(const Waypoints& waypoints, const World& world) {
  const double k = cvar_coefficient(RiskLimit{}.alpha);
  double worst_m = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    const Geodesic geodesic(waypoints[i - 1], waypoints[i]);
    for (int t = 0; t <= 100; ++t) {
      worst_m = std::max(worst_m, max_cvar_m(geodesic.at(t / 100.0), world, k));
    }
  }
  return worst_m;
}

inline double mean_y_at(const Waypoints& waypoints, double x) {
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    const Vec2& a = waypoints[i - 1].mean_m();
    const Vec2& b = waypoints[i].mean_m();
    if ((a.x() - x) * (b.x() - x) > 0.0 || a.x() == b.x()) continue;
    return a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y());
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// A wall with a gap of 2 m on the direct path; above the wall all is open.
//
//   20  .                 .
//   11  .       ##        .      start (2, 5), goal (18, 5)
//       .       ##        .
//    6  .       ##        .      at the gap's middle, (10, 5): 1 + 1 = 2 m of clearance
//    5  S                 G      above the wall, (10, 14): 3 + 10 = 13 m
//    4  .       ##        .
//    0  .       ##        .
inline World gap_or_detour() {
  return World::make({{0, 0}, {20, 20}}, {box(9, -1, 11, 4), box(9, 6, 11, 11)}).value();
}

}  // namespace swarm::planner
