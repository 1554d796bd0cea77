// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/measured_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

constexpr int kMaxFlowRounds = 2000;
constexpr double kConverged = 1e-9;

// Components considered for each robot: those around it on the collocation grid.
constexpr std::size_t kPerRobot = 4;

// A component with less than this share of a robot is left out.
constexpr double kLeastRobots = 0.25;

// Logarithm of the density up to a constant that all Gaussians share. Logarithms, because a density
// of a far robot underflows.
double log_density(const Gaussian& g, const Vec2& at_m) {
  return -0.5 * (g.mahalanobis_squared(at_m) + std::log(g.determinant()));
}

// Vertices that may hold the robot, the likeliest first.
std::vector<std::uint32_t> likeliest(const RiskGraph& graph, const Vec2& robot_m) {
  std::vector<std::pair<double, std::uint32_t>> ranked;
  for (std::uint32_t v = 0; v < graph.own_vertices(); ++v) {
    ranked.emplace_back(-log_density(graph.vertices()[v], robot_m), v);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::uint32_t> chosen;
  // Only components in line of sight count. If none of the nearest dozen is, walls surround the
  // robot, and the likeliest component is taken through the wall.
  for (std::size_t i = 0; i < std::min<std::size_t>(ranked.size(), 3 * kPerRobot); ++i) {
    const Vec2& mean_m = graph.vertices()[ranked[i].second].mean_m();
    if (!graph.world().segment_is_free(robot_m, mean_m, 0.0)) continue;
    chosen.push_back(ranked[i].second);
    if (chosen.size() == kPerRobot) break;
  }
  if (chosen.empty()) chosen.push_back(ranked.front().second);
  return chosen;
}

}  // namespace

// EM with fixed components. Each robot's likelihoods are scaled by the largest, which cancels in
// the update and prevents underflow.
std::vector<double> estimate_weights(std::span<const Gaussian> components,
                                     std::span<const Vec2> positions_m) {
  SWARM_ASSERT(!components.empty() && !positions_m.empty());
  const std::size_t count = components.size();
  std::vector<double> likelihood;  // [robots × components], each robot's largest is 1
  likelihood.reserve(count * positions_m.size());
  for (const Vec2& position_m : positions_m) {
    double largest = -std::numeric_limits<double>::infinity();
    for (const Gaussian& g : components) {
      likelihood.push_back(log_density(g, position_m));
      largest = std::max(largest, likelihood.back());
    }
    for (std::size_t j = likelihood.size() - count; j < likelihood.size(); ++j) {
      likelihood[j] = std::exp(likelihood[j] - largest);
    }
  }
  std::vector<double> weights(count, 1.0 / static_cast<double>(count));
  std::vector<double> next(count);
  for (int round = 0; round < kMaxFlowRounds; ++round) {
    std::fill(next.begin(), next.end(), 0.0);
    for (std::size_t i = 0; i < positions_m.size(); ++i) {
      const double* row = &likelihood[i * count];
      double sum = 0.0;
      for (std::size_t j = 0; j < count; ++j) sum += weights[j] * row[j];
      if (!(sum > 0.0)) continue;  // the weights of all its components are 0
      for (std::size_t j = 0; j < count; ++j) next[j] += weights[j] * row[j] / sum;
    }
    double total = 0.0;
    for (const double weight : next) total += weight;
    double change = 0.0;
    for (std::size_t j = 0; j < count; ++j) {
      next[j] /= total;
      change = std::max(change, std::abs(next[j] - weights[j]));
    }
    std::swap(weights, next);
    if (change < kConverged) break;
  }
  return weights;
}

// Candidates are the components around any robot; components that EM leaves next to no mass are
// removed and the rest scaled to sum to 1.
Mixture measured_mixture(const RiskGraph& graph, std::span<const Vec2> positions_m) {
  SWARM_ASSERT(!positions_m.empty());
  std::vector<std::uint8_t> is_candidate(graph.own_vertices(), 0);
  for (const Vec2& position_m : positions_m) {
    for (const std::uint32_t v : likeliest(graph, position_m)) is_candidate[v] = 1;
  }
  std::vector<Gaussian> components;
  for (std::size_t v = 0; v < is_candidate.size(); ++v) {
    if (is_candidate[v] != 0) components.push_back(graph.vertices()[v]);
  }
  const std::vector<double> weights = estimate_weights(components, positions_m);
  // The threshold is at most the largest weight, so that one component always remains.
  const double heaviest = *std::max_element(weights.begin(), weights.end());
  const double least = std::min(heaviest, kLeastRobots / static_cast<double>(positions_m.size()));
  std::vector<WeightedGaussian> kept;
  double total = 0.0;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    if (weights[j] < least) continue;
    kept.push_back({weights[j], components[j]});
    total += weights[j];
  }
  for (WeightedGaussian& component : kept) component.weight /= total;
  auto mixture = Mixture::make(std::move(kept));
  SWARM_ASSERT(mixture.has_value());
  return *std::move(mixture);
}

}  // namespace swarm::planner
