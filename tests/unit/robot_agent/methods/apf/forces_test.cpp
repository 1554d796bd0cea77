// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Every force of SwarmPRM's eq. 14 against the finite differences of its potential.
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "robot_agent/methods/apf/neighbour_repulsion.hpp"
#include "robot_agent/methods/apf/obstacle_repulsion.hpp"
#include "robot_agent/methods/shared/attraction.hpp"
#include "robot_agent/methods/shared/density_attraction.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

constexpr double kStep_m = 1e-5;

Vec2 minus_gradient(const std::function<double(const Vec2&)>& potential, const Vec2& x) {
  const Vec2 dx(kStep_m, 0), dy(0, kStep_m);
  return {-(potential(x + dx) - potential(x - dx)) / (2 * kStep_m),
          -(potential(x + dy) - potential(x - dy)) / (2 * kStep_m)};
}

Vec2 random_point(Rng& rng, double half_m) {
  return {half_m * (2 * uniform01(rng) - 1), half_m * (2 * uniform01(rng) - 1)};
}

std::vector<Neighbour> dense_region(Rng& rng, int count, double half_m) {
  std::vector<Neighbour> all;
  for (int i = 0; i < count; ++i) {
    all.push_back({.robot = RobotId(static_cast<std::uint32_t>(i)),
                   .position_m = random_point(rng, half_m),
                   .radius_m = 0.2});
  }
  return all;
}

/// U_att = ∫₀^d v(s) ds by Simpson's rule, exact for pieces of straight lines away from kinks.
double attraction_potential(double distance_m, const AttractionSpeed& speed) {
  constexpr int kPieces = 20'000;
  const double h = distance_m / kPieces;
  double sum = 0.0;
  for (int i = 0; i < kPieces; ++i) {
    sum += h / 6 * (speed.at(i * h) + 4 * speed.at((i + 0.5) * h) + speed.at((i + 1) * h));
  }
  return sum;
}

TEST(Forces, AttractionIsTheGradientOfItsPotential) {
  Rng rng(1);
  const Vec2 aim(1, -2);
  for (const AttractionSpeed speed :
       {free_speed(3.0, 0.8, 1.45), free_speed(0.0, 0.8, 1.45),
        AttractionSpeed{.pace_mps = 0.6, .pace_hz = 0.3, .cruise_mps = 1.45},
        AttractionSpeed{.pace_mps = -0.9, .pace_hz = 0.3, .cruise_mps = 1.45},
        AttractionSpeed{.pace_mps = 1.2, .pace_hz = 0.3, .approach_hz = 0.8, .cruise_mps = 1.45}}) {
    const auto potential = [&](const Vec2& x) {
      return attraction_potential((aim - x).norm(), speed);
    };
    for (int i = 0; i < 20; ++i) {
      const Vec2 x = random_point(rng, 6);
      EXPECT_LT((attraction(x, aim, speed) - minus_gradient(potential, x)).norm(), 1e-3);
    }
  }
}

TEST(Forces, AttractionLeadsToTheAim) {
  const Vec2 u = attraction({0, 0}, {3, 4}, free_speed(10, 0.8, 1.45));

  EXPECT_NEAR(u.x(), 1.45 * 0.6, 1e-12);
  EXPECT_NEAR(u.y(), 1.45 * 0.8, 1e-12);
}

TEST(Forces, NeighbourRepulsionIsTheGradientOfItsPotential) {
  Rng rng(2);
  const NeighbourRepulsionOptions options{.radius_m = 0.2, .gap_m = 1.0, .push_mps = 0.6};
  const std::vector<Neighbour> neighbours = dense_region(rng, 12, 2.0);
  const auto potential = [&](const Vec2& x) {
    double sum = 0.0;
    for (const Neighbour& n : neighbours) {
      const double gap = (x - n.position_m).norm() - options.radius_m - n.radius_m;
      const double left = std::max(0.0, 1.0 - gap / options.gap_m);
      sum += 0.5 * options.push_mps * options.gap_m * left * left;
    }
    return sum;
  };
  int compared = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec2 x = random_point(rng, 2.5);
    // Bodies that overlap push as at contact; kinks lie at gap 0 and d₀.
    const bool is_smooth = std::all_of(neighbours.begin(), neighbours.end(), [&](const auto& n) {
      const double gap = (x - n.position_m).norm() - 0.4;
      return gap > 0.01 && std::abs(gap - options.gap_m) > 0.01;
    });
    if (!is_smooth) continue;
    ++compared;
    EXPECT_LT((neighbour_repulsion(x, neighbours, options) - minus_gradient(potential, x)).norm(),
              1e-6);
  }
  EXPECT_GT(compared, 50);
}

TEST(Forces, NeighbourRepulsionLeadsAway) {
  const Neighbour right{.robot = RobotId(1), .position_m = {0.5, 0}, .radius_m = 0.2};

  const Vec2 u = neighbour_repulsion({0, 0}, std::span(&right, 1),
                                     {.radius_m = 0.2, .gap_m = 1.0, .push_mps = 0.6});

  EXPECT_NEAR(u.x(), -0.6 * 0.9, 1e-12);  // a gap of 0.1 m
  EXPECT_EQ(u.y(), 0.0);
}

TEST(Forces, ObstacleRepulsionIsTheGradientOfItsPotential) {
  Rng rng(3);
  const World world = *World::make({{-10, -10}, {10, 10}},
                                   {*Polygon::make({{-1, -1}, {1, -1}, {1.5, 1}, {-1, 0.5}})});
  const ObstacleRepulsionOptions options{.radius_m = 0.2, .gap_m = 0.5, .push_mps = 1.0};
  const auto potential = [&](const Vec2& x) {
    const double gap = world.signed_distance(x).distance_m - options.radius_m;
    const double left = std::max(0.0, 1.0 - gap / options.gap_m);
    return 0.5 * options.push_mps * options.gap_m * left * left;
  };
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec2 x = random_point(rng, 2.5);
    const double gap = world.signed_distance(x).distance_m - options.radius_m;
    if (gap < 0.01 || gap > options.gap_m - 0.01) continue;
    ++compared;
    EXPECT_LT((obstacle_repulsion(x, world, options) - minus_gradient(potential, x)).norm(), 1e-5);
  }
  EXPECT_GT(compared, 100);
}

FlowPlan two_legs() {
  const auto node = [](Vec2 mean, double sigma, double time, double mass) {
    return PlanNode{Gaussian::from_parameters(mean, sigma, 1.5 * sigma, 0.3), MissionTime(time),
                    mass};
  };
  return *FlowPlan::make({node({-3, 0}, 1, 0, 0.4), node({3, 1}, 2, 10, 0.4),
                          node({0, -4}, 1, 0, 0.6), node({0, 4}, 1.5, 10, 0.6)},
                         {{0, 1, 0.4}, {2, 3, 0.6}});
}

TEST(Forces, DensityAttractionIsTheGradientOfItsPotential) {
  Rng rng(4);
  const DensityAttractionOptions options{.push_mps = 0.3, .kernel_m = 2.0};
  PlannedDensity planned;
  update(planned, two_legs(), 5.0, 30, options.kernel_sigma_m());
  const std::vector<Neighbour> neighbours = dense_region(rng, 25, 4.0);
  const auto potential = [&](const Vec2& x) {
    return density_potential(x, planned, neighbours, options);
  };
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec2 x = random_point(rng, 4);
    const Vec2 expected = minus_gradient(potential, x);
    const Vec2 u = density_attraction(x, planned, neighbours, options);
    if (expected.norm() > 0.999 * options.push_mps) {  // where it is no faster than p
      EXPECT_NEAR(u.norm(), options.push_mps, 1e-3);
      EXPECT_GT(u.dot(expected), 0.999 * u.norm() * expected.norm());
      continue;
    }
    ++compared;
    EXPECT_LT((u - expected).norm(), 2e-4);
  }
  EXPECT_GT(compared, 100);
}

/// The density of a mixture is that of all its legs, smoothed by the kernel; compared with a sum
/// over a grid.
TEST(Forces, PlannedDensityIsTheWholeMixtureThroughTheKernel) {
  const double kernel_sigma_m = 0.7;
  PlannedDensity sut;
  update(sut, two_legs(), 5.0, 30, kernel_sigma_m);
  const Mixture mixture = two_legs().mixture_at(MissionTime(5.0));
  const Vec2 x(0.5, 0.3);

  double expected = 0.0;
  constexpr double kGrid_m = 0.05;
  for (double gx = -12; gx < 12; gx += kGrid_m) {
    for (double gy = -12; gy < 12; gy += kGrid_m) {
      const double d2 = (Vec2(gx, gy) - x).squaredNorm();
      const double kernel = std::exp(-0.5 * d2 / (kernel_sigma_m * kernel_sigma_m)) /
                            (2 * std::numbers::pi * kernel_sigma_m * kernel_sigma_m);
      double density = 0.0;
      for (const WeightedGaussian& c : mixture.components()) {
        density += 30 * c.weight * c.gaussian.density({gx, gy});
      }
      expected += kernel * density * kGrid_m * kGrid_m;
    }
  }
  EXPECT_NEAR(sut.at(x).per_m2, expected, 2e-3 * expected);  // parts are cut at 4 σ
}

TEST(Forces, DensityAttractionLeadsOutOfRegionsDenserThanPlanned) {
  PlannedDensity planned;
  update(planned, two_legs(), 5.0, 30, 0.7);
  const std::vector<Neighbour> right{
      {.robot = RobotId(1), .position_m = {0.6, 0}, .radius_m = 0.2},
      {.robot = RobotId(2), .position_m = {0.8, 0.3}, .radius_m = 0.2},
      {.robot = RobotId(3), .position_m = {0.8, -0.3}, .radius_m = 0.2}};

  EXPECT_LT(density_attraction({0, 0}, planned, right, {.push_mps = 0.3}).x(), 0.0);
}

}  // namespace
}  // namespace swarm::agent
