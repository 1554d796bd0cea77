// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/horizon_program.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

Gaussian disc(double x, double y) { return Gaussian::from_parameters({x, y}, 5.0, 5.0, 0.0); }

// A small area with a wall and two goal components.
struct SmallScene {
  World world = World::make({{0, 0}, {60, 40}},
                            {Polygon::make({{28, 0}, {32, 0}, {32, 22}, {28, 22}}).value()})
                    .value();
  Mixture goal = Mixture::make({{0.6, disc(52, 12)}, {0.4, disc(48, 31)}}).value();
  RiskGraph graph =
      RiskGraph::make(world, goal, {.transport_radius_m = 15.0, .mean_clearance_m = 0.5}).value();
  std::vector<double> goal_weights{0.6, 0.4};
  HorizonCosts costs{.horizon = 3};

  std::vector<VertexMass> sources() {
    graph.drop_sources();
    const std::uint32_t a = graph.add_source(disc(12, 11)).value();
    const std::uint32_t b = graph.add_source(disc(9, 30)).value();
    return {{a, 0.7}, {b, 0.3}};
  }
};

// Random limits on what passes some vertices and arcs.
std::vector<WeightRow> random_rows(const RiskGraph& graph, Rng& rng) {
  std::vector<WeightRow> rows;
  for (std::size_t step = 1; step <= 3; ++step) {
    for (const bool by_arc : {false, true}) {
      WeightRow row{step, by_arc, {}};
      const std::size_t places = by_arc ? graph.arcs().size() : graph.vertices().size();
      for (std::uint32_t i = 0; i < places; ++i) {
        if (rng() % 2 == 0) row.entries.push_back({i, uniform(rng, 0.0, 3.0)});
      }
      rows.push_back(row);
    }
  }
  return rows;
}

double coefficient(const WeightRow& row, std::uint32_t index) {
  for (const WeightRow::Entry& entry : row.entries) {
    if (entry.index == index) return entry.coefficient;
  }
  return 0.0;
}

// The paper's form: a variable for every route through vertices and steps (its flow variable F),
// written down by enumeration and solved by the other simplex from nothing.
double cheapest_by_routes(const SmallScene& scene, const std::vector<VertexMass>& sources,
                          const std::vector<WeightRow>& rows) {
  const double unit_m = scene.graph.options().collocation.spacing_m;
  const auto square = [&](double length_m) { return length_m * length_m / (unit_m * unit_m); };
  LinearProgram lp;
  const std::size_t marginals = sources.size() + scene.goal_weights.size();
  std::vector<std::uint32_t> arcs;
  const auto walk = [&](auto&& self, std::size_t source, std::uint32_t at, double cost) -> void {
    if (arcs.size() == scene.costs.horizon) {
      for (std::size_t n = 0; n < scene.goal_weights.size(); ++n) {
        lp.row_index.push_back(static_cast<int>(source));
        lp.value.push_back(1.0);
        lp.row_index.push_back(static_cast<int>(sources.size() + n));
        lp.value.push_back(1.0);
        for (std::size_t r = 0; r < rows.size(); ++r) {
          const std::uint32_t arc = arcs[rows[r].step - 1];
          const double value =
              coefficient(rows[r], rows[r].by_arc ? arc : scene.graph.arcs()[arc].to);
          if (value == 0.0) continue;
          lp.row_index.push_back(static_cast<int>(marginals + r));
          lp.value.push_back(value);
        }
        lp.end_column(cost + scene.costs.lambda_terminal * square(scene.graph.to_goal_m(at, n)));
      }
      return;
    }
    const double lambda = scene.costs.lambda_stage *
                          (1.0 + scene.costs.impatience * static_cast<double>(arcs.size()));
    std::uint32_t index = scene.graph.first_arc_of(at);
    for (const RiskGraph::Arc& arc : scene.graph.arcs_of(at)) {
      arcs.push_back(index++);
      self(self, source, arc.to, cost + lambda * square(arc.w2_m));
      arcs.pop_back();
    }
  };
  for (std::size_t i = 0; i < sources.size(); ++i) {
    walk(walk, i, sources[i].vertex, 0.0);
    lp.row_lower.push_back(sources[i].mass);
    lp.row_upper.push_back(sources[i].mass);
  }
  for (const double weight : scene.goal_weights) {
    lp.row_lower.push_back(weight);
    lp.row_upper.push_back(weight);
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    lp.row_lower.push_back(-std::numeric_limits<double>::infinity());
    lp.row_upper.push_back(1.0);
    lp.row_index.push_back(static_cast<int>(marginals + r));
    lp.value.push_back(-1.0);
    lp.end_column(HorizonProgram::kExcessCost);
  }
  LpBasis basis = slack_basis(lp);
  const LpSolution solution = solve(lp, basis, LpMethod::kPrimalSimplex);
  EXPECT_EQ(solution.status, LpStatus::kOptimal);
  return solution.objective;
}

TEST(HorizonProgram, IsAsCheapAsTheBestOfAllRoutes) {
  SmallScene scene;
  const std::vector<VertexMass> sources = scene.sources();
  const HorizonNetwork network(scene.graph, sources, scene.goal_weights, scene.costs);
  Rng rng(1);
  double unlimited = 0.0;
  for (int i = 0; i < 6; ++i) {
    const std::vector<WeightRow> rows =
        i == 0 ? std::vector<WeightRow>{} : random_rows(scene.graph, rng);
    HorizonProgram program(network, {});

    const LpSolution solution = program.solve(rows);

    ASSERT_EQ(solution.status, LpStatus::kOptimal);
    const double expected = cheapest_by_routes(scene, sources, rows);
    EXPECT_NEAR(solution.objective, expected, 1e-6 * (1.0 + expected));
    if (i == 0) unlimited = expected;
    EXPECT_GE(expected, unlimited - 1e-9);
  }
}

TEST(HorizonProgram, GivesTheSameOptimumAfterOtherPrograms) {
  SmallScene scene;
  const std::vector<VertexMass> sources = scene.sources();
  const HorizonNetwork network(scene.graph, sources, scene.goal_weights, scene.costs);
  Rng rng(2);
  HorizonProgram warm(network, {});
  std::vector<WeightRow> rows;
  for (int i = 0; i < 5; ++i) {
    std::vector<WeightRow> more = random_rows(scene.graph, rng);
    more.insert(more.begin(), rows.begin(), rows.end());  // rows are renewed or appended
    rows = more;
    HorizonProgram cold(network, {});

    const double expected = cold.solve(rows).objective;

    EXPECT_NEAR(warm.solve(rows).objective, expected, 1e-6 * (1.0 + expected));
  }
}

TEST(HorizonProgram, TheWholeProgramHasTheSameOptimum) {
  SmallScene scene;
  const std::vector<VertexMass> sources = scene.sources();
  const HorizonNetwork network(scene.graph, sources, scene.goal_weights, scene.costs);
  Rng rng(3);
  const std::vector<WeightRow> rows = random_rows(scene.graph, rng);
  HorizonProgram program(network, {});
  const double optimum = program.solve(rows).objective;

  const LinearProgram whole = program.whole(rows);
  LpBasis basis = slack_basis(whole);

  EXPECT_EQ(whole.cost.size(), network.columns().size() + rows.size());
  EXPECT_NEAR(solve(whole, basis, LpMethod::kPrimalSimplex).objective, optimum,
              1e-6 * (1.0 + optimum));
}

}  // namespace
}  // namespace swarm::planner
