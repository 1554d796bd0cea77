// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/squeeze.hpp"

#include <cmath>

#include "swarmflow/core/cvar.hpp"

namespace swarm::planner {
namespace {

// Squeezing towards one obstacle may widen the Gaussian a little towards another; in a corner of
// two walls three rounds converge; a position that needs more is too tight to be worth a sample.
constexpr int kRounds = 8;
// Pushes from one obstacle may lead towards another; a mean between two is not pushed for ever.
constexpr int kPushes = 3;
// Aims slightly below the limit, so that rounding does not leave the CVaR above it.
constexpr double kShrink = 1.0 - 1e-9;

}  // namespace

// Per round: the obstacle with the largest CVaR, then the scaling of the deviation along its normal
// that brings this CVaR to δ. The covariance is scaled on both sides, so that it stays symmetric
// and positive definite.
std::optional<Gaussian> squeeze_into_free(const Gaussian& g, const World& world, double k,
                                          double delta_m, double sigma_min_m) {
  const Vec2 mean_m = g.mean_m();
  Gaussian squeezed = g;
  for (int round = 0; round < kRounds; ++round) {
    double worst_m = delta_m;
    SignedDistance at_worst;
    const double spread_m = k * squeezed.max_sigma_m();
    const auto look_at = [&](std::uint32_t i) {
      const ConvexObstacle& obstacle = world.convex_obstacles()[i];
      if (world.convex_boxes().boxes()[i].distance_m(mean_m) >= spread_m - worst_m) return;
      const SignedDistance at_mean = obstacle.signed_distance(mean_m);
      const double cvar_m = obstacle_cvar_m(squeezed, at_mean, k);
      if (cvar_m > worst_m) {
        worst_m = cvar_m;
        at_worst = at_mean;
      }
    };
    world.convex_boxes().for_each_within({mean_m, mean_m}, spread_m - delta_m, look_at);
    if (worst_m <= delta_m) return squeezed;
    const double room_m = at_worst.distance_m + delta_m;
    if (room_m <= 0.0) return std::nullopt;
    const Vec2& n = at_worst.gradient;
    const double q = kShrink * room_m / (k * std::sqrt(squeezed.variance_along_m2(n)));
    const Mat2 a = Mat2::Identity() - (1.0 - q) * n * n.transpose();
    const Mat2 covariance = a * squeezed.covariance_m2() * a;
    if (q < 1e-6) return std::nullopt;
    squeezed = Gaussian::from_valid(squeezed.mean_m(), covariance);
    if (squeezed.min_sigma_m() < sigma_min_m) return std::nullopt;
  }
  return std::nullopt;
}

// Each push moves the mean along the gradient of the distance to the nearest obstacle.
Gaussian push_out(const Gaussian& g, const World& world, double room_m) {
  Vec2 mean_m = g.mean_m();
  for (int push = 0; push < kPushes; ++push) {
    double nearest_m = room_m;
    Vec2 away = Vec2::Zero();
    world.convex_boxes().for_each_within({mean_m, mean_m}, room_m, [&](std::uint32_t i) {
      const ConvexObstacle& obstacle = world.convex_obstacles()[i];
      if (obstacle.box.distance_m(mean_m) >= nearest_m) return;
      const SignedDistance at_mean = obstacle.signed_distance(mean_m);
      if (at_mean.distance_m < nearest_m) {
        nearest_m = at_mean.distance_m;
        away = at_mean.gradient;
      }
    });
    if (nearest_m >= room_m) break;
    mean_m += (room_m - nearest_m) * away;
  }
  return Gaussian::from_valid(mean_m, g.covariance_m2());
}

}  // namespace swarm::planner
