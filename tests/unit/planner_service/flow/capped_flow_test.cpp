// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/capped_flow.hpp"

#include <map>
#include <numbers>
#include <regex>

#include <gtest/gtest.h>

#include "tests/unit/planner_service/flow/flow_scene.hpp"
#include "tests/unit/planner_service/flow/lp_oracle.hpp"

namespace swarm::planner {
namespace {

using test::flow_scene;
using test::FlowScene;

// Straight from the definition: a variable for every arc, what enters a node (or starts there) is
// below its capacity.
std::optional<double> optimum(const FlowScene& scene, const DensityCap& cap) {
  test::LinearProgram lp;
  std::vector<int> conserved;
  std::vector<int> entering;
  for (std::size_t v = 0; v < scene.roadmap.nodes.size(); ++v) {
    const double starts = v < 2 ? scene.supplies[v] : 0.0;
    const double ends = v >= 2 && v < 4 ? scene.demands[v - 2] : 0.0;
    const double capacity = 2.0 * std::numbers::pi * cap.max_per_m2 *
                            std::sqrt(scene.roadmap.nodes[v].determinant()) / cap.robots;
    conserved.push_back(lp.add_row(starts - ends, starts - ends));
    entering.push_back(lp.add_row(-test::LinearProgram::kInfinity, capacity - starts));
  }
  for (std::uint32_t v = 0; v < scene.roadmap.nodes.size(); ++v) {
    for (const Roadmap::Arc& arc : scene.roadmap.arcs_of(v)) {
      lp.add_column(arc.length_m,
                    {{conserved[v], 1.0}, {conserved[arc.to], -1.0}, {entering[arc.to], 1.0}});
    }
  }
  return lp.minimum();
}

Result<CappedFlow> solve(FlowScene& scene, const DensityCap& cap) {
  EdgeChecker checker(scene.world, scene.risk);
  return capped_flow(scene.roadmap, scene.supplies, scene.demands, cap, checker);
}

TEST(CappedFlow, IsAsCheapAsALinearProgramOnRandomRoadmaps) {
  int feasible = 0;
  int infeasible = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    FlowScene scene = flow_scene(seed, 25);
    const DensityCap cap{.max_per_m2 = 1.0, .robots = 40.0 + static_cast<double>(seed % 80)};
    const auto best = optimum(scene, cap);

    const auto flow = solve(scene, cap);

    ASSERT_EQ(flow.has_value(), best.has_value()) << "seed " << seed;
    if (!flow) {
      ++infeasible;
      continue;
    }
    ++feasible;
    EXPECT_NEAR(flow->cost_m, *best, 1e-9 * *best) << "seed " << seed;
  }
  EXPECT_GT(feasible, 30);
  EXPECT_GT(infeasible, 20);
}

TEST(CappedFlow, RoutesCarryTheWeightsAndKeepTheCapacities) {
  int several = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    FlowScene scene = flow_scene(seed, 40);
    const DensityCap cap{.max_per_m2 = 1.0, .robots = 40.0};

    const auto flow = solve(scene, cap);

    if (!flow) continue;
    std::vector<double> out(2, 0.0);
    std::vector<double> in(2, 0.0);
    std::map<std::pair<double, double>, std::pair<double, double>> load;  // by mean: mass, capacity
    double cost_m = 0.0;
    for (const Route& route : flow->routes) {
      EXPECT_GT(route.mass, 1e-9);
      out[route.from] += route.mass;
      in[route.to] += route.mass;
      cost_m += route.mass * w2_length_m(route.waypoints);
      EXPECT_EQ(route.waypoints.front().mean_m(), scene.roadmap.nodes[route.from].mean_m());
      EXPECT_EQ(route.waypoints.back().mean_m(), scene.roadmap.nodes[2 + route.to].mean_m());
      for (const Gaussian& g : route.waypoints) {
        auto& [mass, capacity] = load[{g.mean_m().x(), g.mean_m().y()}];
        mass += route.mass;
        capacity = mass_capacity(g, cap);
      }
    }
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(out[i], scene.supplies[i], 1e-8);
    for (std::size_t j = 0; j < 2; ++j) EXPECT_NEAR(in[j], scene.demands[j], 1e-8);
    for (const auto& [mean, node] : load) EXPECT_LE(node.first, node.second + 1e-9);
    EXPECT_NEAR(cost_m, flow->cost_m, 1e-6);  // masses to 1e-8, paths of 50 m
    several += flow->routes.size() > 4 ? 1 : 0;
  }
  EXPECT_GT(several, 10);
}

TEST(CappedFlow, ReportsTheDensityThatTheWholeSwarmNeeds) {
  int checked = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    FlowScene scene = flow_scene(seed, 25);
    const auto refused = solve(scene, {.max_per_m2 = 1.0, .robots = 140.0});
    if (refused) continue;
    EXPECT_EQ(refused.error().code, ErrorCode::kInfeasible);
    std::smatch found;
    const std::regex enough("all of it fits at ([0-9.]+) robots/m2");
    ASSERT_TRUE(std::regex_search(refused.error().message, found, enough))
        << refused.error().message;
    const double density = std::stod(found[1]);  // printed to 1e-3

    EXPECT_TRUE(solve(scene, {.max_per_m2 = density + 1e-3, .robots = 140.0}).has_value());
    EXPECT_FALSE(solve(scene, {.max_per_m2 = density - 1e-3, .robots = 140.0}).has_value());
    ++checked;
  }
  EXPECT_GT(checked, 10);
}

TEST(CappedFlow, NamesTheComponentThatIsTooDenseByItself) {
  FlowScene scene = flow_scene(1, 10);

  // 60 of 100 robots within 4 m of deviation: 60 / (2 pi 16) = 0.597 robots/m2.
  const auto refused = solve(scene, {.max_per_m2 = 0.5, .robots = 100.0});

  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().message.find("start component 1"), std::string::npos);
  EXPECT_NE(refused.error().message.find("0.597"), std::string::npos) << refused.error().message;
  EXPECT_NE(refused.error().message.find("goal component 0"), std::string::npos);
}

TEST(CappedFlow, ReportsWhenNoDensityHelps) {
  FlowScene scene = flow_scene(1, 0);

  const auto refused = solve(scene, {.max_per_m2 = 1.0, .robots = 100.0});

  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().message.find("no density"), std::string::npos);
}

}  // namespace
}  // namespace swarm::planner
