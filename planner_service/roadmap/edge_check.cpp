// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/edge_check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace swarm::planner {

EdgeChecker::EdgeChecker(const World& world, const RiskLimit& risk)
    : world_(&world), k_(cvar_coefficient(risk.alpha)), delta_m_(risk.delta_m) {}

EdgeChecker::Sweep::Sweep(const Gaussian& a, const Gaussian& b)
    : from_m(a.mean_m()), step_m(b.mean_m() - a.mean_m()) {
  const Mat2 pulled = transport_map(a, b) * a.covariance_m2();
  xx = {a.covariance_m2()(0, 0), 2.0 * pulled(0, 0), b.covariance_m2()(0, 0)};
  xy = {a.covariance_m2()(0, 1), pulled(0, 1) + pulled(1, 0), b.covariance_m2()(0, 1)};
  yy = {a.covariance_m2()(1, 1), 2.0 * pulled(1, 1), b.covariance_m2()(1, 1)};
}

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

EdgeChecker::Rates::Rates(const Gaussian& a, const Gaussian& b, double k, double delta_m) {
  // Along a W₂ geodesic σ_max is convex and σ_min concave: the ends bound both.
  const double sigma_max_m = std::max(a.max_sigma_m(), b.max_sigma_m());
  const double sigma_min_m = std::min(a.min_sigma_m(), b.min_sigma_m());
  mean_way_m = (b.mean_m() - a.mean_m()).norm();
  const double shape_way_m =
      std::sqrt(std::max(0.0, wasserstein2_squared(a, b) - mean_way_m * mean_way_m));
  straight_m = mean_way_m + k * shape_way_m;
  turn_m2 = k * (sigma_max_m - sigma_min_m) * mean_way_m;
  distance_min_m = k * sigma_min_m - delta_m;
}

bool EdgeChecker::is_proven(const Interval& interval, const Rates& rates, double tolerance_m) {
  const auto& [obstacle, from, to] = interval;
  const double share = to.t - from.t;
  const double distance_m = std::max(
      rates.distance_min_m, 0.5 * (from.distance_m + to.distance_m - share * rates.mean_way_m));
  const double rate_m = rates.straight_m + rates.turn_m2 / distance_m;
  return from.slack_m + to.slack_m + 2.0 * tolerance_m >= rate_m * share;
}

bool EdgeChecker::is_free(const Gaussian& a, const Gaussian& b, double tolerance_m) {
  // An obstacle whose box is farther from the box of the way than the widest spread cannot come
  // into play; σ_max² ≤ tr Σ.
  const double spread_m = std::sqrt(std::max(a.covariance_m2().trace(), b.covariance_m2().trace()));
  const double reach_m = k_ * spread_m - delta_m_;
  const Box way{a.mean_m().cwiseMin(b.mean_m()), a.mean_m().cwiseMax(b.mean_m())};
  std::optional<Sweep> sweep;
  open_.clear();
  for (const ConvexObstacle& obstacle : world_->convex_obstacles()) {
    const Vec2 gap =
        (obstacle.box.min_m - way.max_m).cwiseMax(way.min_m - obstacle.box.max_m).cwiseMax(0.0);
    if (gap.squaredNorm() >= reach_m * reach_m) continue;
    if (!sweep) sweep.emplace(a, b);
    const Interval whole{&obstacle, sample(obstacle, *sweep, 0.0), sample(obstacle, *sweep, 1.0)};
    if (whole.from.slack_m < 0.0 || whole.to.slack_m < 0.0) return false;
    if (!faces_one_edge(whole)) open_.push_back(whole);
  }
  if (open_.empty()) return true;
  // First in, first out: the whole edge is looked at coarsely before any part of it finely, and
  // most edges that are not free fall at once.
  const Rates rates(a, b, k_, delta_m_);
  for (std::size_t i = 0; i < open_.size(); ++i) {
    const Interval interval = open_[i];
    if (is_proven(interval, rates, tolerance_m)) continue;
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
