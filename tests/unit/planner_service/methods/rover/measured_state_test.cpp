// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/measured_state.hpp"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"
#include "tests/unit/planner_service/methods/rover/rover_scene.hpp"

namespace swarm::planner {
namespace {

Gaussian disc(double x, double y, double sigma) {
  return Gaussian::from_parameters({x, y}, sigma, sigma, 0.0);
}

std::vector<Vec2> samples_of(const std::vector<Gaussian>& components,
                             const std::vector<double>& weights, std::size_t count, Rng& rng) {
  std::vector<Vec2> samples;
  for (std::size_t i = 0; i < count; ++i) {
    double u = uniform(rng, 0.0, 1.0);
    std::size_t j = 0;
    while (j + 1 < weights.size() && u >= weights[j]) u -= weights[j++];
    const double x = standard_normal(rng);
    samples.push_back(components[j].mean_m() + cholesky_lower(components[j].covariance_m2()) *
                                                   Vec2(x, standard_normal(rng)));
  }
  return samples;
}

double log_likelihood(const std::vector<Gaussian>& components, const std::vector<double>& weights,
                      const std::vector<Vec2>& positions_m) {
  double sum = 0.0;
  for (const Vec2& position_m : positions_m) {
    double density = 0.0;
    for (std::size_t j = 0; j < components.size(); ++j) {
      density += weights[j] * components[j].density(position_m);
    }
    sum += std::log(density);
  }
  return sum;
}

TEST(EstimateWeights, RecoversThoseTheRobotsWereDrawnFrom) {
  const std::vector<Gaussian> components{disc(0, 0, 7), disc(10, 0, 7), disc(20, 10, 7),
                                         disc(60, 60, 7)};
  const std::vector<double> weights{0.5, 0.2, 0.3, 0.0};
  Rng rng(1);

  const auto estimate = estimate_weights(components, samples_of(components, weights, 20'000, rng));

  // Components 1.4 σ apart: the standard error of such weights is about 3/√N = 0.02.
  for (std::size_t j = 0; j < weights.size(); ++j) EXPECT_NEAR(estimate[j], weights[j], 0.05) << j;
  EXPECT_NEAR(std::accumulate(estimate.begin(), estimate.end(), 0.0), 1.0, 1e-12);
}

TEST(EstimateWeights, NoOtherWeightsAreLikelier) {
  const std::vector<Gaussian> components{disc(0, 0, 7), disc(10, 0, 7), disc(0, 10, 7),
                                         disc(10, 10, 7)};
  Rng rng(2);
  const auto positions = samples_of(components, {0.4, 0.3, 0.2, 0.1}, 200, rng);

  const auto estimate = estimate_weights(components, positions);

  const double best = log_likelihood(components, estimate, positions);
  for (int i = 0; i < 500; ++i) {
    std::vector<double> other = estimate;
    const double step = i % 2 == 0 ? 1.0 : 0.01;
    double total = 0.0;
    for (double& weight : other) {
      weight += step * uniform(rng, 0.0, 1.0);
      total += weight;
    }
    for (double& weight : other) weight /= total;
    // EM stops when weights change by 1e-9, far below this.
    EXPECT_LE(log_likelihood(components, other, positions), best + 1e-5);
  }
}

TEST(EstimateWeights, SurvivesARobotFarFromAll) {
  const std::vector<Gaussian> components{disc(0, 0, 1), disc(5, 0, 1)};
  const std::vector<Vec2> positions{{0, 0}, {1e4, 0}};

  const auto estimate = estimate_weights(components, positions);

  // The near one is exp(−12.5) likely to be of the other component.
  EXPECT_NEAR(estimate[0], 0.5, 1e-5);
  EXPECT_NEAR(estimate[1], 0.5, 1e-5);
}

TEST(MeasuredMixture, HasTheRobotsMeanAndNothingBehindWalls) {
  const Mission mission = test::rover_scene(2);
  const RiskGraph graph = RiskGraph::make(mission.world, mission.goal, {}).value();
  Rng rng(3);
  std::vector<Vec2> robots;
  Vec2 mean_m = Vec2::Zero();
  while (robots.size() < 100) {
    const double x = standard_normal(rng);
    const Vec2 robot_m = Vec2(115, 62) + 6.0 * Vec2(x, standard_normal(rng));
    if (!mission.world.is_clear(robot_m, 0.2)) continue;
    robots.push_back(robot_m);
    mean_m += robot_m / 100.0;
  }

  const Mixture mixture = measured_mixture(graph, robots);

  Vec2 mixture_mean_m = Vec2::Zero();
  for (const auto& [weight, g] : mixture.components()) {
    mixture_mean_m += weight * g.mean_m();
    EXPECT_GE(weight, 0.25 / 100.0);
    EXPECT_LT(g.mean_m().x(), 130.0) << "beyond the wall";
    EXPECT_TRUE(graph.find(g).has_value());
  }
  // Components are 10 m apart and the swarm's own width is that of one.
  EXPECT_LT((mixture_mean_m - mean_m).norm(), 2.0);
}

}  // namespace
}  // namespace swarm::planner
