// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/edge_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace swarm::planner {

EdgeChecker::EdgeChecker(const World& world, const RiskLimit& risk, double scale)
    : world_(&world), k_(cvar_coefficient(risk.alpha)), delta_m_(risk.delta_m), scale_(scale) {}

// Coefficients of the polynomials of Σ(t) for its three distinct entries.
EdgeChecker::Sweep::Sweep(const Gaussian& a, const Gaussian& b)
    : from_m(a.mean_m()), step_m(b.mean_m() - a.mean_m()) {
  const Mat2 pulled = transport_map(a, b) * a.covariance_m2();
  xx = {a.covariance_m2()(0, 0), 2.0 * pulled(0, 0), b.covariance_m2()(0, 0)};
  xy = {a.covariance_m2()(0, 1), pulled(0, 1) + pulled(1, 0), b.covariance_m2()(0, 1)};
  yy = {a.covariance_m2()(1, 1), 2.0 * pulled(1, 1), b.covariance_m2()(1, 1)};
}

// Slack δ − CVaR at t against one obstacle: CVaR of the distance linearised at the mean.
EdgeChecker::Sample EdgeChecker::sample(const ConvexObstacle& obstacle, const Sweep& sweep,
                                        double t) const {
  const std::array weights{(1.0 - t) * (1.0 - t), t * (1.0 - t), t * t};
  const auto at = [&](const std::array<double, 3>& c) {
    return weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2];
  };
  const auto [to_obstacle, face] = obstacle.faced(sweep.from_m + t * sweep.step_m);
  const Vec2& n = to_obstacle.gradient;
  const double variance_m2 = at(sweep.xx) * n.x() * n.x() + 2.0 * at(sweep.xy) * n.x() * n.y() +
                             at(sweep.yy) * n.y() * n.y();
  const double cvar_m = -to_obstacle.distance_m + k_ * std::sqrt(std::max(0.0, variance_m2));
  return {t, delta_m_ - cvar_m, to_obstacle.distance_m, face};
}

// The slack of an end at an obstacle, from the cache of the end. The edges of a node meet the same
// few obstacles.
const EdgeEnd::Seen& EdgeChecker::look(EdgeEnd& end, std::uint32_t obstacle) const {
  const std::size_t place = obstacle % EdgeEnd::kSeen;
  EdgeEnd::Seen& seen = end.seen_[place];
  if (end.seen_obstacle_[place] != obstacle) {
    const auto [to_obstacle, face] = world_->convex_obstacles()[obstacle].faced(end.mean_m());
    const double cvar_m = obstacle_cvar_m(end.gaussian(), to_obstacle, k_);
    end.seen_obstacle_[place] = obstacle;
    seen = {delta_m_ - cvar_m, to_obstacle.distance_m, face};
  }
  return seen;
}

EdgeChecker::Rates::Rates(const EdgeEnd& a, const EdgeEnd& b, double k, double delta_m) {
  // Along a W₂ geodesic σ_max is convex and σ_min concave: the ends bound both.
  const double sigma_max_m = std::max(a.sigma_max_m(), b.sigma_max_m());
  const double sigma_min_m = std::min(a.sigma_min_m(), b.sigma_min_m());
  const double mean_path_squared = (b.mean_m() - a.mean_m()).squaredNorm();
  mean_path_m = std::sqrt(mean_path_squared);
  const double shape_path_m = std::sqrt(
      std::max(0.0, wasserstein2_squared(a.gaussian(), b.gaussian()) - mean_path_squared));
  straight_m = mean_path_m + k * shape_path_m;
  turn_m2 = k * (sigma_max_m - sigma_min_m) * mean_path_m;
  distance_min_m = k * sigma_min_m - delta_m;
}

// The condition a + b + 2 · tolerance ≥ L h of the class comment. The distance in the turning term
// is bounded below by what both ends allow, and by the limit itself.
bool EdgeChecker::is_proven(const Interval& interval, const Rates& rates, double tolerance_m) {
  const auto& [obstacle, from, to] = interval;
  const double share = to.t - from.t;
  const double distance_m = std::max(
      rates.distance_min_m, 0.5 * (from.distance_m + to.distance_m - share * rates.mean_path_m));
  const double rate_m = rates.straight_m + rates.turn_m2 / distance_m;
  return from.slack_m + to.slack_m + 2.0 * tolerance_m >= rate_m * share;
}

// First the ends against every obstacle within reach, which refutes most edges. Obstacles with one
// face towards both ends are done; for the others intervals are halved until proven or refuted.
bool EdgeChecker::is_free(EdgeEnd& a, EdgeEnd& b, double tolerance_m) {
  const Vec2& from_m = a.mean_m();
  const Vec2& to_m = b.mean_m();
  const Box path{from_m.cwiseMin(to_m), from_m.cwiseMax(to_m)};
  open_.clear();
  const bool breaks_at_an_end = world_->convex_boxes().any_within(
      path, reach_m(std::max(a.sigma_max_m(), b.sigma_max_m())), [&](std::uint32_t i) {
        const EdgeEnd::Seen& from = look(a, i);
        const EdgeEnd::Seen& to = look(b, i);
        if (from.slack_m < 0.0 || to.slack_m < 0.0) return true;
        if (from.face == to.face && from.face != ConvexObstacle::kNoFace) return false;
        open_.push_back({&world_->convex_obstacles()[i],
                         {0.0, from.slack_m, from.distance_m, from.face},
                         {1.0, to.slack_m, to.distance_m, to.face}});
        return false;
      });
  if (breaks_at_an_end) return false;
  if (open_.empty()) return true;
  // First in, first out: the whole edge is tested coarsely before any part of it finely, which
  // refutes most edges that are not free after few samples.
  const Rates rates(a, b, k_, delta_m_);
  std::optional<Sweep> sweep;
  for (std::size_t i = 0; i < open_.size(); ++i) {
    const Interval interval = open_[i];
    if (is_proven(interval, rates, scale_ * tolerance_m)) continue;
    if (i >= kMostIntervals) return false;
    if (!sweep) sweep.emplace(a.gaussian(), b.gaussian());
    const Sample middle =
        sample(*interval.obstacle, *sweep, 0.5 * (interval.from.t + interval.to.t));
    if (middle.slack_m < 0.0) return false;
    for (const Interval& half : {Interval{interval.obstacle, interval.from, middle},
                                 Interval{interval.obstacle, middle, interval.to}}) {
      if (!faces_one_edge(half)) open_.push_back(half);
    }
  }
  return true;
}

}  // namespace swarm::planner
