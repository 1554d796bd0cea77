// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/horizon_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "planner_service/methods/rover/ftmpc.hpp"

namespace swarm::planner {
namespace {

constexpr std::size_t kHorizon = 3;

Gaussian disc(double x, double y) { return Gaussian::from_parameters({x, y}, 5.0, 5.0, 0.0); }

// A small area with a wall from below, two goal components on its right, two sources on its left.
struct SmallNetwork {
  World world = World::make({{0, 0}, {60, 40}},
                            {Polygon::make({{28, 0}, {32, 0}, {32, 22}, {28, 22}}).value()})
                    .value();
  Mixture goal = Mixture::make({{0.6, disc(52, 12)}, {0.4, disc(48, 31)}}).value();
  RiskGraph graph =
      RiskGraph::make(world, goal, {.transport_radius_m = 15.0, .mean_clearance_m = 0.5}).value();
  std::vector<VertexMass> sources{{graph.add_source(disc(12, 11)).value(), 0.7},
                                  {graph.add_source(disc(9, 30)).value(), 0.3}};
  std::vector<double> goal_weights{0.6, 0.4};
  HorizonNetwork network{graph, sources, goal_weights, {.horizon = kHorizon}};
};

// Every path from a source to a goal component, as columns, with its cost.
struct Path {
  std::uint32_t source = 0;
  std::uint32_t goal = 0;
  double cost = 0.0;
  std::vector<std::size_t> columns;
};

std::vector<Path> all_paths(const SmallNetwork& small) {
  std::multimap<std::pair<std::uint32_t, std::uint32_t>, std::size_t> leaving;
  const auto& columns = small.network.columns();
  for (std::size_t c = 0; c < columns.size(); ++c) {
    leaving.emplace(std::pair(columns[c].stage, columns[c].from), c);
  }
  std::vector<Path> paths;
  Path path;
  const auto walk = [&](auto&& self, std::uint32_t stage, std::uint32_t at) -> void {
    const auto [first, last] = leaving.equal_range({stage, at});
    for (auto it = first; it != last; ++it) {
      const HorizonNetwork::Column& column = columns[it->second];
      path.columns.push_back(it->second);
      path.cost += column.cost;
      if (stage == kHorizon) {
        path.goal = column.to;
        paths.push_back(path);
      } else {
        self(self, stage + 1, column.to);
      }
      path.cost -= column.cost;
      path.columns.pop_back();
    }
  };
  for (const VertexMass& source : small.sources) {
    path.source = source.vertex;
    walk(walk, 0, source.vertex);
  }
  return paths;
}

TEST(HorizonNetwork, HasALayerForWhatEachNumberOfStepsReaches) {
  const SmallNetwork small;
  std::vector<bool> reached(small.network.vertices(), false);
  for (const VertexMass& source : small.sources) reached[source.vertex] = true;
  for (std::size_t step = 0; step <= kHorizon; ++step) {
    std::vector<bool> next(reached.size(), false);
    for (std::uint32_t v = 0; v < reached.size(); ++v) {
      EXPECT_EQ(small.network.in_layer(step, v), reached[v]) << v << " after " << step;
      if (!reached[v]) continue;
      for (const RiskGraph::Arc& arc : small.graph.arcs_of(v)) next[arc.to] = true;
    }
    reached = std::move(next);
  }
}

TEST(HorizonNetwork, HasTheMassesOfSourcesAndGoalsOnItsRightSide) {
  const SmallNetwork small;
  const std::vector<double>& right = small.network.right_side();

  double others = 0.0;
  for (const double value : right) others += std::abs(value);
  for (const VertexMass& source : small.sources) {
    EXPECT_EQ(right[small.network.row(0, source.vertex)], source.mass);
    others -= source.mass;
  }
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(right[small.network.goal_row(n)], small.goal_weights[n]);
    others -= small.goal_weights[n];
  }
  EXPECT_NEAR(others, 0.0, 1e-12) << "in between, what comes leaves";
}

TEST(HorizonNetwork, DetoursAreThoseOfAllPathsOneByOne) {
  const SmallNetwork small;
  const std::vector<Path> paths = all_paths(small);
  ASSERT_GT(paths.size(), 1000U);
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> cheapest;
  for (const Path& path : paths) {
    const auto [it, is_new] = cheapest.emplace(std::pair(path.source, path.goal), path.cost);
    if (!is_new) it->second = std::min(it->second, path.cost);
  }
  std::vector<double> expected(small.network.columns().size(),
                               std::numeric_limits<double>::infinity());
  for (const Path& path : paths) {
    const double detour = path.cost - cheapest[{path.source, path.goal}];
    for (const std::size_t c : path.columns) expected[c] = std::min(expected[c], detour);
  }

  const std::vector<double> detours = small.network.detours();

  ASSERT_EQ(detours.size(), expected.size());
  for (std::size_t c = 0; c < expected.size(); ++c) {
    if (std::isinf(expected[c])) {
      EXPECT_TRUE(std::isinf(detours[c])) << c;
    } else {
      EXPECT_NEAR(detours[c], expected[c], 1e-9) << c;
    }
  }
}

TEST(HorizonNetwork, CheapestRoutesJoinEverySourceWithEveryGoal) {
  const SmallNetwork small;
  const auto& columns = small.network.columns();
  const std::vector<double> detours = small.network.detours();

  const std::vector<std::size_t> routes = small.network.cheapest_routes();

  // A path of h stages and the terminal transport for each pair.
  ASSERT_EQ(routes.size(), 2 * 2 * (kHorizon + 1));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> joined;
  for (std::size_t i = 0; i < routes.size(); i += kHorizon + 1) {
    for (std::size_t stage = 0; stage <= kHorizon; ++stage) {
      const HorizonNetwork::Column& column = columns[routes[i + stage]];
      EXPECT_EQ(column.stage, stage);
      EXPECT_NEAR(detours[routes[i + stage]], 0.0, 1e-9);
      if (stage > 0) {
        EXPECT_EQ(column.from, columns[routes[i + stage - 1]].to);
      }
    }
    joined.emplace_back(columns[routes[i]].from, columns[routes[i + kHorizon]].to);
  }
  std::sort(joined.begin(), joined.end());
  const std::uint32_t a = small.sources[0].vertex;
  const std::uint32_t b = small.sources[1].vertex;
  EXPECT_EQ(joined,
            (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{a, 0}, {a, 1}, {b, 0}, {b, 1}}));
}

TEST(HorizonNetwork, WeightsAreTheFlowThroughVerticesAndArcs) {
  const SmallNetwork small;
  const std::vector<Path> paths = all_paths(small);
  // Mass on a few paths, as x by column; negligible negative values, as solvers return, are 0.
  std::vector<double> x(small.network.columns().size(), -1e-12);
  std::vector<std::map<std::uint32_t, double>> through(kHorizon + 1);
  for (std::size_t i = 0; i < 10; ++i) {
    const Path& path = paths[i * paths.size() / 10];
    for (const std::size_t c : path.columns) {
      x[c] = std::max(0.0, x[c]) + 0.1;
      const HorizonNetwork::Column& column = small.network.columns()[c];
      if (column.stage < kHorizon) through[column.stage + 1][column.to] += 0.1;
    }
  }
  for (std::size_t step = 1; step <= kHorizon; ++step) {
    const std::vector<double> weights = small.network.vertex_weights(step, x);
    const std::vector<double> by_arc = small.network.arc_weights(step, x);
    std::vector<double> into(weights.size(), 0.0);
    for (std::size_t arc = 0; arc < by_arc.size(); ++arc) {
      into[small.graph.arcs()[arc].to] += by_arc[arc];
    }
    for (std::uint32_t v = 0; v < weights.size(); ++v) {
      EXPECT_NEAR(weights[v], through[step][v], 1e-12);
      EXPECT_NEAR(into[v], weights[v], 1e-12);
    }
  }
}

TEST(HorizonMemory, IsEmptyAtFirstAndShiftsOneStepAhead) {
  HorizonMemory memory(3, 2, 4);
  const auto value = [](std::size_t step, std::size_t part, std::size_t obstacle) {
    return static_cast<double>(100 * step + 10 * part + obstacle);
  };
  for (std::size_t step = 1; step <= 3; ++step) {
    for (std::size_t part = 0; part < 2; ++part) {
      for (std::size_t o = 0; o < 4; ++o) {
        EXPECT_TRUE(std::isnan(memory.from_m(step, part, o)));
        memory.from_m(step, part, o) = value(step, part, o);
      }
    }
    ASSERT_EQ(memory.arcs().size(), 3U);
    memory.arcs()[step - 1] = {{static_cast<std::uint32_t>(step), 7}};
  }

  memory.shift();

  for (std::size_t part = 0; part < 2; ++part) {
    for (std::size_t o = 0; o < 4; ++o) {
      EXPECT_EQ(memory.from_m(1, part, o), value(2, part, o));
      EXPECT_EQ(memory.from_m(2, part, o), value(3, part, o));
    }
  }
  EXPECT_EQ(memory.arcs()[0].at(0).first, 2U);
  EXPECT_EQ(memory.arcs()[1].at(0).first, 3U);
  EXPECT_TRUE(memory.arcs()[2].empty()) << "nothing is known of the last step";
}

}  // namespace
}  // namespace swarm::planner
