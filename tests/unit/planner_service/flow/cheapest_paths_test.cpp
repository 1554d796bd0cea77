// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/cheapest_paths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/planner_service/flow/flow_scene.hpp"

namespace swarm::planner {
namespace {

constexpr double kNoPath = std::numeric_limits<double>::infinity();

// Lengths between all pairs by Floyd and Warshall.
std::vector<std::vector<double>> all_lengths(const Roadmap& roadmap) {
  const std::size_t n = roadmap.nodes.size();
  std::vector<std::vector<double>> length(n, std::vector<double>(n, kNoPath));
  for (std::uint32_t v = 0; v < n; ++v) {
    length[v][v] = 0.0;
    for (const Roadmap::Arc& arc : roadmap.arcs_of(v)) length[v][arc.to] = arc.length_m;
  }
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        length[i][j] = std::min(length[i][j], length[i][k] + length[k][j]);
      }
    }
  }
  return length;
}

double arc_length(const Roadmap& roadmap, std::uint32_t from, std::uint32_t to) {
  for (const Roadmap::Arc& arc : roadmap.arcs_of(from)) {
    if (arc.to == to) return arc.length_m;
  }
  return kNoPath;
}

// Of two starts and two goals: the mass from start 0 to goal 0 decides all others, and the cost is
// linear in it, so that an end of its range is optimal.
double least_cost(const std::vector<double>& costs, const std::vector<double>& supplies,
                  const std::vector<double>& demands) {
  const auto cost = [&](double mass) {
    const double shares[] = {mass, supplies[0] - mass, demands[0] - mass,
                             supplies[1] - demands[0] + mass};
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (shares[i] > 1e-12) sum += shares[i] * costs[i];
    }
    return sum;
  };
  return std::min(cost(std::max(0.0, demands[0] - supplies[1])),
                  cost(std::min(supplies[0], demands[0])));
}

TEST(TransportOnPaths, TakesTheCheapestPathsAndTheCheapestTransport) {
  int feasible = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto scene = test::flow_scene(seed, 14);
    const auto length = all_lengths(scene.roadmap);

    const PathTransport transport =
        transport_on_paths(scene.roadmap, scene.supplies, scene.demands);

    ASSERT_EQ(transport.costs.size(), 4U);
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t j = 0; j < 2; ++j) {
        if (std::isinf(length[i][2 + j])) {
          EXPECT_TRUE(std::isinf(transport.costs[2 * i + j]));
        } else {
          EXPECT_NEAR(transport.costs[2 * i + j], length[i][2 + j], 1e-9);
        }
      }
    }
    const double expected = least_cost(transport.costs, scene.supplies, scene.demands);
    ASSERT_EQ(transport.paths.empty(), std::isinf(expected)) << "seed " << seed;
    if (transport.paths.empty()) continue;
    ++feasible;
    double cost = 0.0;
    for (const auto& [shipment, nodes] : transport.paths) {
      double length_m = 0.0;
      for (std::size_t k = 1; k < nodes.size(); ++k) {
        length_m += arc_length(scene.roadmap, nodes[k - 1], nodes[k]);
      }
      EXPECT_EQ(nodes.front(), shipment.from);
      EXPECT_EQ(nodes.back(), 2 + shipment.to);
      EXPECT_NEAR(length_m, transport.costs[2 * shipment.from + shipment.to], 1e-9);
      cost += shipment.mass * length_m;
    }
    EXPECT_NEAR(cost, expected, 1e-6);  // every component counts at least 1e-9
  }
  EXPECT_GT(feasible, 5);
}

TEST(TransportOnPaths, TakesNoClosedEdge) {
  const auto at = [](double x, double y) { return Gaussian::from_parameters({x, y}, 1, 1, 0); };
  // A start, a goal, and two nodes beside the straight line, one nearer than the other.
  std::vector<NeighbourPair> edges{{0, 2, 11.0}, {1, 2, 11.0}, {0, 3, 14.0}, {1, 3, 14.0}};
  Roadmap roadmap = assemble({at(0, 0), at(20, 0), at(10, 5), at(10, -10)}, edges);
  const std::vector<double> one{1.0};
  ASSERT_EQ(transport_on_paths(roadmap, one, one).paths.at(0).nodes,
            (std::vector<std::uint32_t>{0, 2, 1}));

  roadmap.close_edge(2, 1);

  const PathTransport detour = transport_on_paths(roadmap, one, one);
  ASSERT_EQ(detour.paths.size(), 1U);
  EXPECT_EQ(detour.paths[0].nodes, (std::vector<std::uint32_t>{0, 3, 1}));
  EXPECT_NEAR(detour.costs[0], 28.0, 1e-12);

  roadmap.close_edge(3, 1);

  EXPECT_TRUE(transport_on_paths(roadmap, one, one).paths.empty());
  EXPECT_TRUE(std::isinf(transport_on_paths(roadmap, one, one).costs[0]));
}

}  // namespace
}  // namespace swarm::planner
