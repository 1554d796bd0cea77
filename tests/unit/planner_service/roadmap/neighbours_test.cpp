// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "planner_service/roadmap/connect.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

Gaussian random_gaussian(Rng& rng, double sigma_max_m) {
  return Gaussian::from_parameters({uniform(rng, 0, 100), uniform(rng, 0, 100)},
                                   uniform(rng, 0.5, sigma_max_m), uniform(rng, 0.5, sigma_max_m),
                                   uniform(rng, -0.8, 0.8));
}

// Wide terminals first, then samples.
std::vector<Gaussian> scene(Rng& rng, std::size_t terminals, std::size_t samples) {
  std::vector<Gaussian> nodes;
  for (std::size_t i = 0; i < terminals; ++i) nodes.push_back(random_gaussian(rng, 20.0));
  for (std::size_t i = 0; i < samples; ++i) nodes.push_back(random_gaussian(rng, 3.0));
  return nodes;
}

// How far a terminal reaches, from the definition.
double reach_m(const std::vector<Gaussian>& nodes, std::size_t terminal, std::size_t terminals,
               double radius_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t b = terminals; b < nodes.size(); ++b) {
    nearest_m = std::min(nearest_m, wasserstein2(nodes[terminal], nodes[b]));
  }
  return nodes.size() > terminals ? std::max(radius_m, 2.0 * nearest_m) : radius_m;
}

TEST(TerminalNeighbours, ReachTwiceAsFarAsToTheNearestSample) {
  Rng rng(1);
  for (int round = 0; round < 20; ++round) {
    constexpr std::size_t kTerminals = 5;
    constexpr double kRadius_m = 8.0;
    const std::vector<Gaussian> nodes = scene(rng, kTerminals, 80);
    for (std::uint32_t a = 0; a < kTerminals; ++a) {
      const double reach = reach_m(nodes, a, kTerminals, kRadius_m);
      std::vector<std::uint32_t> expected;
      for (std::uint32_t b = a + 1; b < nodes.size(); ++b) {
        const double distance_m = wasserstein2(nodes[a], nodes[b]);
        ASSERT_GT(std::abs(distance_m - reach), 1e-9) << "a tie would be decided by rounding";
        if (distance_m < reach) expected.push_back(b);
      }

      std::vector<std::uint32_t> found;
      for (const NeighbourPair& pair : terminal_neighbours(nodes, a, kTerminals, kRadius_m)) {
        EXPECT_EQ(pair.a, a);
        EXPECT_EQ(pair.distance_m, wasserstein2(nodes[a], nodes[pair.b]));
        found.push_back(pair.b);
      }

      EXPECT_EQ(found, expected) << "terminal " << a;
    }
  }
}

TEST(TerminalNeighbours, AreThoseOfTheSearchForAllNodes) {
  Rng rng(2);
  constexpr std::size_t kTerminals = 4;
  const std::vector<Gaussian> nodes = scene(rng, kTerminals, 120);

  const auto all = find_neighbours(nodes, 10.0, kTerminals);

  std::size_t next = 0;
  for (std::uint32_t a = 0; a < kTerminals; ++a) {
    for (const NeighbourPair& pair : terminal_neighbours(nodes, a, kTerminals, 10.0)) {
      ASSERT_LT(next, all.size());
      EXPECT_EQ(all[next].a, pair.a);
      EXPECT_EQ(all[next].b, pair.b);
      ++next;
    }
  }
  for (; next < all.size(); ++next) EXPECT_GE(all[next].a, kTerminals) << "samples come after";
}

TEST(TerminalNeighbours, HaveTheRadiusAloneWithoutSamples) {
  const auto at = [](double x) { return Gaussian::from_parameters({x, 0}, 1, 1, 0); };
  const std::vector<Gaussian> nodes{at(0), at(5), at(50)};

  const auto pairs = find_neighbours(nodes, 6.0, 3);

  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].a, 0U);
  EXPECT_EQ(pairs[0].b, 1U);
  EXPECT_EQ(find_neighbours(nodes, 6.0, 99).size(), 1U) << "more terminals than nodes are all";
}

TEST(Assemble, KeepsEveryEdgeTwiceInTheOrderGiven) {
  Rng rng(3);
  for (int round = 0; round < 50; ++round) {
    const std::vector<Gaussian> nodes = scene(rng, 0, 1 + rng() % 12);
    std::vector<NeighbourPair> edges;
    for (std::uint32_t a = 0; a < nodes.size(); ++a) {
      for (std::uint32_t b = a + 1; b < nodes.size(); ++b) {
        if (rng() % 3 == 0) edges.push_back({a, b, uniform(rng, 1.0, 9.0)});
      }
    }
    std::shuffle(edges.begin(), edges.end(), rng);

    const Roadmap roadmap = assemble(nodes, edges);

    EXPECT_EQ(roadmap.edge_count(), edges.size());
    ASSERT_EQ(roadmap.arc_offset.size(), nodes.size() + 1);
    for (std::uint32_t v = 0; v < nodes.size(); ++v) {
      std::size_t arc = 0;
      for (const NeighbourPair& edge : edges) {
        if (edge.a != v && edge.b != v) continue;
        ASSERT_LT(arc, roadmap.arcs_of(v).size());
        EXPECT_EQ(roadmap.arcs_of(v)[arc].to, edge.a == v ? edge.b : edge.a);
        EXPECT_EQ(roadmap.arcs_of(v)[arc].length_m, edge.distance_m);
        ++arc;
      }
      EXPECT_EQ(arc, roadmap.arcs_of(v).size()) << "no more than the edges";
    }
  }
  EXPECT_EQ(assemble({}, {}).edge_count(), 0U);
}

TEST(Assemble, ClosingAnEdgeThatIsNotThereChangesNothing) {
  const auto at = [](double x) { return Gaussian::from_parameters({x, 0}, 1, 1, 0); };
  const std::vector<NeighbourPair> edges{{0, 1, 3.0}, {1, 2, 4.0}};
  Roadmap roadmap = assemble({at(0), at(3), at(7)}, edges);

  roadmap.close_edge(0, 2);
  roadmap.close_edge(1, 1);

  for (const Roadmap::Arc& arc : roadmap.arcs) EXPECT_LT(arc.length_m, 5.0);
  EXPECT_EQ(roadmap.edge_count(), 2U);
}

}  // namespace
}  // namespace swarm::planner
