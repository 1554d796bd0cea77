// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/neighbours.hpp"
#include "planner_service/roadmap/sampler.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

TEST(Neighbours, AreAllPairsWithinTheRadius) {
  const auto scene = test::standin_scene();
  Rng rng(1);
  const auto nodes = sample_free(scene.world, {}, {.sigma_max_m = 6.0}, 300, rng);

  const auto pairs = find_neighbours(nodes, 20.0);

  std::size_t next = 0;
  for (std::uint32_t a = 0; a < nodes.size(); ++a) {
    for (std::uint32_t b = a + 1; b < nodes.size(); ++b) {
      if (wasserstein2(nodes[a], nodes[b]) > 20.0) continue;
      ASSERT_LT(next, pairs.size());
      EXPECT_EQ(pairs[next].a, a);
      EXPECT_EQ(pairs[next].b, b);
      EXPECT_EQ(pairs[next].distance_m, wasserstein2(nodes[a], nodes[b]));
      ++next;
    }
  }
  EXPECT_EQ(next, pairs.size());
}

TEST(Neighbours, CountTheRadiusItself) {
  const auto at = [](double x) { return Gaussian::from_parameters({x, 0}, 1, 1, 0); };
  const std::vector<Gaussian> row{at(0), at(3), at(6.001)};

  const auto pairs = find_neighbours(row, 3.0);

  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].b, 1U);
  EXPECT_TRUE(find_neighbours({}, 3.0).empty());

  // A terminal 50 m from its nearest sample reaches 100 m; samples reach 3 m.
  const std::vector<Gaussian> far = {at(0), at(50), at(52), at(99), at(101)};
  const auto reached = find_neighbours(far, 3.0, 1);
  ASSERT_EQ(reached.size(), 5U);
  EXPECT_EQ(reached[2].a, 0U);
  EXPECT_EQ(reached[2].b, 3U);
  EXPECT_EQ(reached[3].a, 1U);
  EXPECT_EQ(reached[4].a, 3U);
}

TEST(Roadmap, HasExactlyTheFreeNeighboursInBothDirections) {
  const auto scene = test::standin_scene();
  Rng rng(2);
  EdgeChecker checker(scene.world, {});
  const auto nodes = sample_free(scene.world, {}, {}, 200, rng);
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> expected;
  for (std::uint32_t a = 0; a < nodes.size(); ++a) {
    for (std::uint32_t b = a + 1; b < nodes.size(); ++b) {
      const double length_m = wasserstein2(nodes[a], nodes[b]);
      if (length_m > 20.0 || !checker.is_free(nodes[a], nodes[b], kBuildTolerance_m)) continue;
      expected[{a, b}] = expected[{b, a}] = length_m;
    }
  }

  const Roadmap roadmap = connect(nodes, 20.0, checker);

  EXPECT_EQ(roadmap.arcs.size(), expected.size());
  EXPECT_EQ(roadmap.edge_count(), expected.size() / 2);
  for (std::uint32_t node = 0; node < roadmap.nodes.size(); ++node) {
    for (const Roadmap::Arc& arc : roadmap.arcs_of(node)) {
      const auto found = expected.find({node, arc.to});
      ASSERT_NE(found, expected.end());
      EXPECT_EQ(found->second, arc.length_m);
    }
  }
}

TEST(Roadmap, ClosesAnEdgeInBothDirections) {
  const auto at = [](double x) { return Gaussian::from_parameters({x, 0}, 1, 1, 0); };
  const World world;
  EdgeChecker checker(world, {});
  Roadmap roadmap = connect({at(0), at(3), at(6)}, 4.0, checker);
  ASSERT_EQ(roadmap.edge_count(), 2U);

  roadmap.close_edge(1, 0);

  EXPECT_TRUE(std::isinf(roadmap.arcs_of(0)[0].length_m));
  EXPECT_TRUE(std::isinf(roadmap.arcs_of(1)[0].length_m));
  EXPECT_EQ(roadmap.arcs_of(1)[1].length_m, 3.0);
  EXPECT_EQ(roadmap.arcs_of(2)[0].length_m, 3.0);
}

}  // namespace
}  // namespace swarm::planner
