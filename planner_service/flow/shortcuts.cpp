// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/shortcuts.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "planner_service/roadmap/connect.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

// A shortcut must save this much: rounding alone is no progress.
constexpr double kWorthwhile_m = 1e-6;

// A point on a route: on the leg that starts at waypoint `leg`.
struct RoutePoint {
  std::size_t leg = 0;
  double along_m = 0.0;  // from the route's start
  Gaussian gaussian;
};

// The point of a route at a W₂ length from its start: on a geodesic, length is proportional to t.
RoutePoint point_at(const Waypoints& waypoints, const std::vector<double>& along_m,
                    double target_m) {
  const auto after = std::upper_bound(along_m.begin(), along_m.end(), target_m);
  const auto leg =
      std::min(static_cast<std::size_t>(after - along_m.begin()), along_m.size() - 1) - 1;
  const double length_m = along_m[leg + 1] - along_m[leg];
  const double t =
      length_m > 0.0 ? std::clamp((target_m - along_m[leg]) / length_m, 0.0, 1.0) : 0.0;
  return {leg, along_m[leg] + t * length_m, Geodesic(waypoints[leg], waypoints[leg + 1]).at(t)};
}

// W₂ length from the start of the route to each waypoint.
std::vector<double> lengths_along(const Waypoints& waypoints) {
  std::vector<double> along_m{0.0};
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    along_m.push_back(along_m.back() + wasserstein2(waypoints[i - 1], waypoints[i]));
  }
  return along_m;
}

}  // namespace

// Random shortcuts: the saving is tested first, since the edge check costs far more. Both points
// become waypoints, those between them are removed.
void take_shortcuts(Waypoints& waypoints, std::uint32_t tries, EdgeChecker& checker, Rng& rng) {
  std::vector<double> along_m = lengths_along(waypoints);
  for (std::uint32_t i = 0; i < tries && waypoints.size() > 2; ++i) {
    double from_m = uniform(rng, 0.0, along_m.back());
    double to_m = uniform(rng, 0.0, along_m.back());
    if (from_m > to_m) std::swap(from_m, to_m);
    const RoutePoint from = point_at(waypoints, along_m, from_m);
    const RoutePoint to = point_at(waypoints, along_m, to_m);
    if (from.leg == to.leg) continue;
    const double saved_m = to.along_m - from.along_m - wasserstein2(from.gaussian, to.gaussian);
    if (saved_m < kWorthwhile_m) continue;
    if (!checker.is_free(from.gaussian, to.gaussian, kPlanTolerance_m)) continue;
    Waypoints shorter(waypoints.begin(),
                      waypoints.begin() + static_cast<std::ptrdiff_t>(from.leg) + 1);
    if (from.along_m > along_m[from.leg]) shorter.push_back(from.gaussian);
    if (to.along_m < along_m[to.leg + 1]) shorter.push_back(to.gaussian);
    shorter.insert(shorter.end(), waypoints.begin() + static_cast<std::ptrdiff_t>(to.leg) + 1,
                   waypoints.end());
    waypoints = std::move(shorter);
    along_m = lengths_along(waypoints);
  }
}

// One pass from the start; after a removal the same position is tried again with its new neighbour.
void drop_superfluous(Waypoints& waypoints, EdgeChecker& checker) {
  for (std::size_t i = 1; i + 1 < waypoints.size();) {
    if (checker.is_free(waypoints[i - 1], waypoints[i + 1], kPlanTolerance_m)) {
      waypoints.erase(waypoints.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
}

}  // namespace swarm::planner
