// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/route.hpp"

#include <algorithm>
#include <cmath>

#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

// Least duration of a leg: times have to increase along it even where nothing moves.
constexpr double kShortestLeg_s = 1e-3;
constexpr double kEllipseSigmas = 2.0;  // 86 % of the robots are inside
constexpr int kHalvings = 60;

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

// W₂² is the squared path of the mean plus the mean square path about the mean. The leg takes the
// time of the longer of the two.
double leg_duration_s(const Gaussian& from, const Gaussian& to, double speed_mps) {
  const double mean_path_m = (to.mean_m() - from.mean_m()).norm();
  const double squared = wasserstein2_squared(from, to);
  const double shape_path_m = std::sqrt(std::max(0.0, squared - mean_path_m * mean_path_m));
  return std::max(std::max(mean_path_m, shape_path_m) / speed_mps, kShortestLeg_s);
}

double longest_robot_path_m(const Gaussian& from, const Gaussian& to) {
  // y = 2Lu, |u| ≤ 1: the longest |a + Bu|, B = 2(T − I)L.
  const Vec2 a = to.mean_m() - from.mean_m();
  const Mat2 b = kEllipseSigmas * (transport_map(from, to) - Mat2::Identity()) *
                 cholesky_lower(from.covariance_m2());
  // max |a + Bu|² = min over λ ≥ s₁ of |a|² + λ + c₁²/(λ − s₁) + c₂²/(λ − s₂), where sᵢ are the
  // eigenvalues of BᵀB and cᵢ the parts of Bᵀa along its eigenvectors.
  const Mat2 square = b.transpose() * b;
  const Vec2 pull = b.transpose() * a;
  const double middle = 0.5 * (square(0, 0) + square(1, 1));
  const double apart = std::hypot(0.5 * (square(0, 0) - square(1, 1)), square(0, 1));
  const double s1 = middle + apart;
  const double s2 = middle - apart;
  const double angle = 0.5 * std::atan2(2.0 * square(0, 1), square(0, 0) - square(1, 1));
  const double c1 = std::cos(angle) * pull.x() + std::sin(angle) * pull.y();
  const double c2 = -std::sin(angle) * pull.x() + std::cos(angle) * pull.y();
  const auto part = [](double c, double gap) { return c == 0.0 ? 0.0 : c / gap; };
  // The slope in λ is 1 − Σ (cᵢ/(λ − sᵢ))²: at most 0 just above s₁, or there is the minimum.
  double low = s1;
  double high = s1 * (1.0 + 1e-12) + pull.norm();
  for (int i = 0; i < kHalvings; ++i) {
    const double at = 0.5 * (low + high);
    const double p1 = part(c1, at - s1);
    const double p2 = part(c2, at - s2);
    (p1 * p1 + p2 * p2 > 1.0 ? low : high) = at;
  }
  const double squared =
      a.squaredNorm() + high + c1 * part(c1, high - s1) + c2 * part(c2, high - s2);
  return std::sqrt(std::max(0.0, squared));
}

// Without a limit for the robots it is the duration for the means alone.
double end_leg_duration_s(const Gaussian& from, const Gaussian& to, const LegSpeed& speed) {
  const double means_s = leg_duration_s(from, to, speed.means_mps);
  if (!std::isfinite(speed.robots_mps)) return means_s;
  return std::max(means_s, longest_robot_path_m(from, to) / speed.robots_mps);
}

double route_leg_duration_s(const Waypoints& waypoints, std::size_t i, const LegSpeed& speed) {
  const bool is_end = i == 1 || i + 1 == waypoints.size();
  return is_end ? end_leg_duration_s(waypoints[i - 1], waypoints[i], speed)
                : leg_duration_s(waypoints[i - 1], waypoints[i], speed.means_mps);
}

}  // namespace swarm::planner
