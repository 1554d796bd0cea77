// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/shortest_routes.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/sampler.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

TEST(ShortestRoutes, AreAsShortAsFloydAndWarshallFindThem) {
  const auto scene = test::standin_scene();
  EdgeChecker checker(scene.world, {});
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Rng rng(seed);
    // Sparse enough to fall into several pieces.
    const Roadmap roadmap = connect(sample_free(scene.world, {}, {}, 80, rng), 18.0, checker);
    const std::size_t n = roadmap.nodes.size();
    std::vector<double> d(n * n, std::numeric_limits<double>::infinity());
    for (std::uint32_t i = 0; i < n; ++i) {
      d[i * n + i] = 0.0;
      for (const auto& arc : roadmap.arcs_of(i)) d[i * n + arc.to] = arc.length_m;
    }
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
          d[i * n + j] = std::min(d[i * n + j], d[i * n + k] + d[k * n + j]);
        }
      }
    }
    std::vector<std::uint32_t> all(n);
    for (std::uint32_t i = 0; i < n; ++i) all[i] = i;

    for (std::uint32_t i = 0; i < n; i += 7) {
      const ShortestRoutes routes(roadmap, i, all);
      const ShortestRoutes towards_one(roadmap, i, std::span(all).subspan(n - 1));
      EXPECT_EQ(towards_one.length_m(all.back()), routes.length_m(all.back()));
      for (std::uint32_t j = 0; j < n; ++j) {
        const auto nodes = routes.nodes_to(j);
        if (std::isinf(d[i * n + j])) {
          EXPECT_TRUE(std::isinf(routes.length_m(j)));
          EXPECT_TRUE(nodes.empty());
          continue;
        }
        ASSERT_FALSE(nodes.empty());
        EXPECT_EQ(nodes.front(), i);
        EXPECT_EQ(nodes.back(), j);
        double length_m = 0.0;
        for (std::size_t s = 1; s < nodes.size(); ++s) {
          length_m += wasserstein2(roadmap.nodes[nodes[s - 1]], roadmap.nodes[nodes[s]]);
        }
        // Sums of the same numbers in another order.
        EXPECT_NEAR(routes.length_m(j), d[i * n + j], 1e-9);
        EXPECT_NEAR(length_m, d[i * n + j], 1e-9);
      }
    }
  }
}

TEST(RouteTable, IsTheSameFromWhicheverSideItSearches) {
  const auto scene = test::standin_scene();
  EdgeChecker checker(scene.world, {});
  Rng rng(3);
  const Roadmap roadmap = connect(sample_free(scene.world, {}, {}, 200, rng), 18.0, checker);
  const std::vector<std::uint32_t> few{3, 50};
  const std::vector<std::uint32_t> many{7, 3, 120, 199};

  const RouteTable forward(roadmap, few, many);
  const RouteTable backward(roadmap, many, few);

  for (std::size_t i = 0; i < few.size(); ++i) {
    const ShortestRoutes search(roadmap, few[i], many);
    for (std::size_t j = 0; j < many.size(); ++j) {
      EXPECT_NEAR(forward.length_m(i, j), search.length_m(many[j]), 1e-9);
      EXPECT_NEAR(backward.length_m(j, i), search.length_m(many[j]), 1e-9);
      const auto there = forward.nodes(i, j);
      const auto back = backward.nodes(j, i);
      ASSERT_FALSE(there.empty());
      EXPECT_EQ(there.front(), few[i]);
      EXPECT_EQ(there.back(), many[j]);
      EXPECT_TRUE(std::equal(there.rbegin(), there.rend(), back.begin(), back.end()));
    }
  }
}

TEST(ShortestRoutes, AcceptArcsOfAnyLength) {
  // A row of nodes a millimetre apart, one a kilometre away, and the same place twice.
  const auto at = [](double x) { return Gaussian::from_parameters({x, 0}, 1, 1, 0); };
  std::vector<Gaussian> nodes;
  for (int i = 0; i < 200; ++i) nodes.push_back(at(1e-3 * i));
  nodes.push_back(at(0.0));
  nodes.push_back(at(1000.0));
  std::vector<NeighbourPair> edges;
  for (std::uint32_t i = 0; i + 1 < 200; ++i) edges.push_back({i, i + 1, 1e-3});
  edges.push_back({0, 200, 0.0});
  edges.push_back({199, 201, 999.801});
  edges.push_back({200, 201, 1001.0});
  const Roadmap roadmap = assemble(nodes, edges);
  const std::vector<std::uint32_t> far{201};

  const ShortestRoutes routes(roadmap, 200, far);

  EXPECT_NEAR(routes.length_m(201), 1000.0, 1e-9);
  EXPECT_EQ(routes.nodes_to(201).size(), 202U);
}

}  // namespace
}  // namespace swarm::planner
