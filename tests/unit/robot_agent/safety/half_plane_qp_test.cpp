// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/safety/half_plane_qp.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

double worst_violation(const Vec2& u, const std::vector<HalfPlane>& constraints) {
  double worst = 0.0;
  for (const HalfPlane& c : constraints) worst = std::max(worst, c.normal.dot(u) - c.bound_mps);
  return worst;
}

/// Squared distance of the best feasible point, found by trying every candidate an optimum can be:
/// the desired velocity, its projections on lines and the circle, all intersections.
double brute_force(const Vec2& desired_velocity, const std::vector<HalfPlane>& constraints,
                   double speed_max) {
  std::vector<Vec2> candidates = {desired_velocity};
  if (desired_velocity.norm() > 0)
    candidates.push_back(desired_velocity * (speed_max / desired_velocity.norm()));
  for (const HalfPlane& a : constraints) {
    candidates.push_back(desired_velocity +
                         (a.bound_mps - a.normal.dot(desired_velocity)) * a.normal);
    const double chord = speed_max * speed_max - a.bound_mps * a.bound_mps;
    if (chord >= 0) {
      const Vec2 along(-a.normal.y(), a.normal.x());
      candidates.push_back(a.bound_mps * a.normal + std::sqrt(chord) * along);
      candidates.push_back(a.bound_mps * a.normal - std::sqrt(chord) * along);
    }
    for (const HalfPlane& b : constraints) {
      const double det = a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x();
      if (std::abs(det) < 1e-9) continue;
      candidates.push_back({(a.bound_mps * b.normal.y() - b.bound_mps * a.normal.y()) / det,
                            (a.normal.x() * b.bound_mps - b.normal.x() * a.bound_mps) / det});
    }
  }
  double best = std::numeric_limits<double>::infinity();
  for (const Vec2& u : candidates) {
    if (u.norm() > speed_max + 1e-9 || worst_violation(u, constraints) > 1e-9) continue;
    best = std::min(best, (u - desired_velocity).squaredNorm());
  }
  return best;
}

TEST(HalfPlaneQp, EqualsTheBestOfAllCandidatePoints) {
  Rng rng(7);
  int feasible = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::vector<HalfPlane> constraints(rng() % 9);
    for (HalfPlane& c : constraints) {
      c = {unit(uniform(rng, 0, 2 * std::numbers::pi)), uniform(rng, -0.4, 1.5)};
    }
    const Vec2 desired_velocity(uniform(rng, -2, 2), uniform(rng, -2, 2));

    const auto u = nearest_velocity(desired_velocity, constraints, 1.5);

    const double best = brute_force(desired_velocity, constraints, 1.5);
    if (!u) {
      // Scenes that differ from infeasible ones by rounding only may go either way.
      EXPECT_TRUE(std::isinf(best) || worst_violation(Vec2::Zero(), constraints) > 0) << round;
      continue;
    }
    ++feasible;
    EXPECT_LE(u->norm(), 1.5 + 1e-6);
    EXPECT_LE(worst_violation(*u, constraints), 1e-6);
    EXPECT_NEAR((*u - desired_velocity).squaredNorm(), best, 1e-5)
        << round;  // 1e-9 slack times the geometry's gain
  }
  EXPECT_GT(feasible, 10'000);
}

TEST(HalfPlaneQp, ReportsWhenNothingIsAllowed) {
  const std::vector<HalfPlane> constraints = {{{1, 0}, -0.5}, {{-1, 0}, -0.5}};

  EXPECT_FALSE(nearest_velocity({0, 0}, constraints, 1.5).has_value());
}

TEST(HalfPlaneQp, LimitsSpeedWithoutConstraints) {
  const auto u = nearest_velocity({3, 4}, {}, 1.5);

  ASSERT_TRUE(u.has_value());
  EXPECT_NEAR(u->x(), 0.9, 1e-12);
  EXPECT_NEAR(u->y(), 1.2, 1e-12);
}

}  // namespace
}  // namespace swarm::agent
