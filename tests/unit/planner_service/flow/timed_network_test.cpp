// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/timed_network.hpp"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "planner_service/flow/density_cap.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "tests/unit/planner_service/flow/flow_scene.hpp"
#include "tests/unit/planner_service/flow/lp_oracle.hpp"

namespace swarm::planner {
namespace {

using test::flow_scene;
using test::FlowScene;

constexpr double kSpeed_mps = 2.0;
constexpr double kStep_s = 3.0;
constexpr double kDelayCost_mps = 0.1;
constexpr double kEverything = 1e6;

TimedNetwork network_of(const FlowScene& scene) {
  EdgeChecker checker(scene.world, scene.risk);
  return {scene.roadmap,
          2,
          2,
          {.speed = {.means_mps = kSpeed_mps},
           .step_s = kStep_s,
           .detour = kEverything,
           .delay_cost_mps = kDelayCost_mps},
          checker};
}

std::vector<double> capacities_of(const FlowScene& scene, double robots) {
  std::vector<double> capacities;
  for (const Gaussian& g : scene.roadmap.nodes) {
    capacities.push_back(mass_capacity(g, {.max_per_m2 = 1.0, .robots = robots}));
  }
  return capacities;
}

// Straight from the definition, with every node at every step: y[v, t] waits at v from t to t + 1,
// x[a, t] leaves along arc a at t. What is at v at t came or waited, and is below the capacity.
std::optional<double> optimum(const FlowScene& scene, const std::vector<double>& capacities,
                              int horizon) {
  const Roadmap& roadmap = scene.roadmap;
  test::LinearProgram lp;
  std::map<std::pair<std::size_t, int>, int> conserved;
  std::map<std::pair<std::size_t, int>, int> present;
  for (std::size_t v = 0; v < roadmap.nodes.size(); ++v) {
    for (int t = 0; t <= horizon; ++t) {
      const double starts = v < 2 && t == 0 ? scene.supplies[v] : 0.0;
      const double ends = v >= 2 && v < 4 && t == horizon ? scene.demands[v - 2] : 0.0;
      conserved[{v, t}] = lp.add_row(starts - ends, starts - ends);
      present[{v, t}] = lp.add_row(-test::LinearProgram::kInfinity, capacities[v] - starts);
    }
  }
  const auto add = [&](std::size_t v, int t, std::size_t w, int then, double cost) {
    if (then > horizon) return;
    lp.add_column(
        cost, {{conserved[{v, t}], 1.0}, {conserved[{w, then}], -1.0}, {present[{w, then}], 1.0}});
  };
  for (std::uint32_t v = 0; v < roadmap.nodes.size(); ++v) {
    for (int t = 0; t < horizon; ++t) {
      add(v, t, v, t + 1, v >= 2 && v < 4 ? 0.0 : kDelayCost_mps * kStep_s);
      for (const Roadmap::Arc& arc : roadmap.arcs_of(v)) {
        const Vec2 path_m = roadmap.nodes[arc.to].mean_m() - roadmap.nodes[v].mean_m();
        const double shape_m = std::sqrt(arc.length_m * arc.length_m - path_m.squaredNorm());
        const double lasts_s = std::max(path_m.norm(), shape_m) / kSpeed_mps;
        const int steps = static_cast<int>(std::ceil(lasts_s / kStep_s));
        add(v, t, arc.to, t + steps, arc.length_m + kDelayCost_mps * kStep_s * steps);
      }
    }
  }
  return lp.minimum();
}

TEST(TimedNetwork, IsAsCheapAsALinearProgramOverAllNodesAndSteps) {
  int feasible = 0;
  int infeasible = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const FlowScene scene = flow_scene(seed, 12, 20.0, 2.0);
    const TimedNetwork network = network_of(scene);
    const auto free_flow = network.free_flow_steps();
    if (!free_flow) continue;
    const std::uint32_t horizon = *free_flow + static_cast<std::uint32_t>(seed % 4);
    const std::vector<double> capacities =
        capacities_of(scene, 20.0 + static_cast<double>(seed % 60));
    const auto best = optimum(scene, capacities, static_cast<int>(horizon));

    const auto moves = network.solve(horizon, {scene.supplies, scene.demands, capacities});

    ASSERT_EQ(moves.has_value(), best.has_value()) << "seed " << seed;
    if (!moves) {
      ++infeasible;
      EXPECT_LT(network.mass_that_fits(horizon, {scene.supplies, scene.demands, capacities}), 1.0);
      continue;
    }
    ++feasible;
    double cost = 0.0;
    for (const TimedMove& move : *moves) {
      const bool has_arrived = move.from == move.to && move.from >= 2 && move.from < 4;
      cost +=
          move.mass * wasserstein2(scene.roadmap.nodes[move.from], scene.roadmap.nodes[move.to]);
      cost += has_arrived ? 0.0
                          : move.mass * kDelayCost_mps * kStep_s * (move.to_step - move.from_step);
    }
    EXPECT_NEAR(cost, *best, 1e-9 * *best) << "seed " << seed;
  }
  EXPECT_GT(feasible, 5);
  EXPECT_GT(infeasible, 5);
}

TEST(TimedNetwork, LetsGroupsPassOneAfterTheOtherThroughABottleneck) {
  // One narrow node between the two, for a third of the swarm: three waves.
  const World world = World::make({{0, 0}, {40, 10}}, {}).value();
  const auto at = [](double x) { return Gaussian::from_parameters({x, 5}, 2.0, 2.0, 0.0); };
  const Roadmap roadmap{.nodes = {at(8), at(32), at(20)},
                        .arc_offset = {0, 1, 2, 4},
                        .arcs = {{2, 12.0}, {2, 12.0}, {0, 12.0}, {1, 12.0}}};
  EdgeChecker checker(world, {});
  const std::vector<double> one{1.0};
  const std::vector<double> capacities{1.0, 1.0, 0.34};
  const TimedNetwork network(roadmap, 1, 1, {.speed = {.means_mps = 4.0}, .step_s = 3.0}, checker);

  ASSERT_EQ(network.free_flow_steps(), 2U);
  EXPECT_FALSE(network.solve(2, {one, one, capacities}).has_value());
  EXPECT_NEAR(network.mass_that_fits(2, {one, one, capacities}), 0.34, 1e-12);
  EXPECT_NEAR(network.mass_that_fits(3, {one, one, capacities}), 0.68, 1e-12);
  EXPECT_TRUE(network.solve(4, {one, one, capacities}).has_value());
}

TEST(TimedNetwork, HasNoTimeWhereNoPathLeads) {
  const FlowScene scene = flow_scene(1, 0);

  EXPECT_FALSE(network_of(scene).free_flow_steps().has_value());
}

}  // namespace
}  // namespace swarm::planner
