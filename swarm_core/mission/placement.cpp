// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/placement.hpp"

#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"

namespace swarm {
namespace {

/// Tries per robot before its component counts as full: free space of 0.2 % of the probability is
/// still found with probability 1 − e⁻²⁰.
constexpr int kMaxTries = 10'000;
/// Attempts to place all robots: in a dense component, random placement leaves gaps that are too
/// small for another robot, and how many depends on the draw.
constexpr std::uint64_t kAttempts = 10;

/// Robots placed so far, in square cells as wide as the least distance: a robot that is too near to
/// a point is in one of the nine cells around it.
class PlacedRobots {
 public:
  explicit PlacedRobots(double least_distance_m) : cell_m_(least_distance_m) {}

  bool is_clear(const Vec2& p) const {
    const auto [x, y] = cell_of(p);
    for (std::int64_t i = x - 1; i <= x + 1; ++i) {
      for (std::int64_t j = y - 1; j <= y + 1; ++j) {
        const auto it = cells_.find(key(i, j));
        if (it == cells_.end()) continue;
        for (const Vec2& other : it->second) {
          if ((other - p).squaredNorm() < cell_m_ * cell_m_) return false;
        }
      }
    }
    return true;
  }

  void add(const Vec2& p) {
    const auto [x, y] = cell_of(p);
    cells_[key(x, y)].push_back(p);
  }

 private:
  std::pair<std::int64_t, std::int64_t> cell_of(const Vec2& p) const {
    return {static_cast<std::int64_t>(std::floor(p.x() / cell_m_)),
            static_cast<std::int64_t>(std::floor(p.y() / cell_m_))};
  }
  // A hash of both indices. Cells that collide share a bucket, which costs distance checks and
  // changes no result.
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    return mix_seed(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
  }

  double cell_m_;
  std::unordered_map<std::uint64_t, std::vector<Vec2>> cells_;
};

/// Rejection sampling, robot after robot (random sequential addition). Each robot has its own
/// generator, so its samples do not depend on how many tries the robots before it needed.
Result<std::vector<Vec2>> place_once(const Mission& mission, std::uint64_t seed) {
  const RobotsSpec& spec = mission.robots;
  const double radius_m = largest_radius_m(spec);
  // As far from the walls as the safety filter keeps robots.
  const Vec2 wall_m = Vec2::Constant(radius_m + mission.safety.obstacle_margin_m);
  const Box free_m{mission.world.bounds_m().min_m + wall_m,
                   mission.world.bounds_m().max_m - wall_m};
  // All robots keep the distances of the largest one: a robot's position then does not depend on
  // its group.
  const double obstacle_clearance_m = radius_m + spec.placement_gap_m;
  PlacedRobots placed(2.0 * radius_m + spec.placement_gap_m);
  std::vector<Vec2> positions;
  positions.reserve(spec.count);
  for (std::uint32_t robot = 0; robot < spec.count; ++robot) {
    const std::size_t component = mission.start.component_at(stratified_share(robot, spec.count));
    const Gaussian& gaussian = mission.start.components()[component].gaussian;
    const Mat2 lower = cholesky_lower(gaussian.covariance_m2());
    Rng rng(mix_seed(seed, robot));
    const auto try_once = [&] {
      const double z0 = standard_normal(rng);
      const double z1 = standard_normal(rng);
      const Vec2 p = gaussian.mean_m() + lower * Vec2(z0, z1);
      if (!free_m.contains(p) || !gaussian.contains_99(p) || !placed.is_clear(p) ||
          mission.world.distance_m(p) < obstacle_clearance_m) {
        return false;
      }
      placed.add(p);
      positions.push_back(p);
      return true;
    };
    int tries = 0;
    while (tries < kMaxTries && !try_once()) ++tries;
    if (tries == kMaxTries) {
      return fail(
          ErrorCode::kInfeasible,
          fmt::format("start[{}] has no room for robot {} of {}; place fewer robots, enlarge "
                      "its covariance_m2 or lower robots.placement_gap_m ({})",
                      component, robot, spec.count, spec.placement_gap_m));
    }
  }
  return positions;
}

}  // namespace

double stratified_share(std::uint32_t robot, std::uint32_t robots) {
  SWARM_ASSERT(robot < robots);
  return (static_cast<double>(robot) + 0.5) / static_cast<double>(robots);
}

/// The first attempt uses the seed itself; later ones use seeds derived from it, so the result
/// stays a function of mission and seed.
Result<std::vector<Vec2>> place_robots(const Mission& mission, std::uint64_t seed) {
  Result<std::vector<Vec2>> placed = place_once(mission, seed);
  for (std::uint64_t again = 1; again < kAttempts && !placed; ++again) {
    placed = place_once(mission, mix_seed(seed, ~again));
  }
  return placed;
}

}  // namespace swarm
