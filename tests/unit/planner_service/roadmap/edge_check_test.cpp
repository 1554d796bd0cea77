// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/edge_check.hpp"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "planner_service/roadmap/sampler.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

double dense_max_cvar_m(const Gaussian& a, const Gaussian& b, const World& world, double k,
                        int steps) {
  const Geodesic geodesic(a, b);
  double worst_m = -std::numeric_limits<double>::infinity();
  for (int i = 0; i <= steps; ++i) {
    worst_m = std::max(worst_m, max_cvar_m(geodesic.at(static_cast<double>(i) / steps), world, k));
  }
  return worst_m;
}

TEST(EdgeChecker, AgreesWithADenseGridUpToItsTolerance) {
  const auto scene = test::standin_scene();
  const RiskLimit risk;
  const double k = cvar_coefficient(risk.alpha);
  EdgeChecker checker(scene.world, risk);
  Rng rng(1);
  // Wide ranges: shapes that change much and normals that turn near corners.
  const SamplerOptions options{.sigma_min_m = 0.5, .sigma_max_m = 8.0, .rho_max = 0.9};
  const auto nodes = sample_free(scene.world, risk, options, 300, rng);
  int free_edges = 0;
  int edges = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t j = i + 1; j < nodes.size(); ++j) {
      if (wasserstein2(nodes[i], nodes[j]) > 25.0) continue;
      const double dense_m = dense_max_cvar_m(nodes[i], nodes[j], scene.world, k, 512);
      ++edges;
      free_edges += dense_m <= risk.delta_m ? 1 : 0;

      for (const double tolerance_m : {0.1, 1e-3}) {
        if (checker.is_free(nodes[i], nodes[j], tolerance_m)) {
          EXPECT_LE(dense_m, risk.delta_m + tolerance_m);
        } else {
          // Between points of the grid, 5 cm apart at most, CVaR moves by less than 0.15 m.
          EXPECT_GT(dense_m, risk.delta_m - 0.15);
        }
      }
    }
  }
  EXPECT_GT(free_edges, 500);
  EXPECT_GT(edges - free_edges, 300);
}

TEST(EdgeChecker, SeesAnObstacleThinnerThanAnyGrid) {
  // 2 mm wide, between two narrow Gaussians: the graze is 0.4 % of the edge.
  const auto needle = Polygon::make({{9.999, -50}, {10.001, -50}, {10.001, 0}, {9.999, 0}}).value();
  const World world = World::make({{-10, -60}, {30, 10}}, {needle}).value();
  EdgeChecker checker(world, {});
  // A clearance of k·0.02 + 0.2 = 0.2413 m is needed above the tip.
  const auto at = [](double x, double y) {
    return Gaussian::from_parameters({x, y}, 0.02, 0.02, 0.0);
  };

  EXPECT_FALSE(checker.is_free(at(0, 0.240), at(20, 0.240), 1e-3));
  EXPECT_TRUE(checker.is_free(at(0, 0.242), at(20, 0.242), 1e-3));
  EXPECT_FALSE(checker.is_free(at(0, -5), at(20, -5), 0.1));
}

TEST(EdgeChecker, ComesToAnEndAlongAWallAtTheLimit) {
  const auto wall = Polygon::make({{-500, -50}, {500, -50}, {500, 0}, {-500, 0}}).value();
  const World world = World::make({{-500, -50}, {500, 500}}, {wall}).value();
  const RiskLimit risk;
  const double limit_m = cvar_coefficient(risk.alpha) * 2.0 - risk.delta_m;
  EdgeChecker checker(world, risk);
  const auto at = [](double x, double y) {
    return Gaussian::from_parameters({x, y}, 1.0, 2.0, 0.0);
  };

  EXPECT_TRUE(checker.is_free(at(-100, limit_m + 1e-9), at(100, limit_m + 1e-9), 1e-3));
  EXPECT_FALSE(checker.is_free(at(-100, limit_m - 1e-6), at(100, limit_m - 1e-6), 1e-3));
}

TEST(EdgeChecker, FindsEverythingFreeInAnEmptyWorld) {
  const World world;
  EdgeChecker checker(world, {});

  EXPECT_TRUE(checker.is_free(Gaussian::from_parameters({0, 0}, 10, 10, 0),
                              Gaussian::from_parameters({900, 0}, 1, 1, 0), 1e-3));
}

}  // namespace
}  // namespace swarm::planner
