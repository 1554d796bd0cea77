// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Random instances of the transport problem (13), the flow under a density cap, and the same
// unrolled over time, one JSON object a line with the optimum found here; flow_check.py solves them
// again with HiGHS:
//   build/bench/bin/flow_check | python3 tests/bench/flow_check.py
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "planner_service/flow/capped_flow.hpp"
#include "planner_service/flow/timed_network.hpp"
#include "planner_service/flow/transport_lp.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/sampler.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::planner {
namespace {

constexpr double kSpeed_mps = 1.25;
constexpr double kStep_s = 8.0;
constexpr double kDelayCost_mps = 0.1;

std::vector<double> random_weights(std::size_t count, Rng& rng) {
  std::vector<double> weights(count);
  double sum = 0.0;
  for (double& weight : weights) sum += weight = uniform(rng, 1e-3, 1.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

// Shortest text that reads back as the same number; a problem without a solution is null.
std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

std::string list(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number(value));
  return fmt::format("[{}]", fmt::join(texts, ","));
}

void print_transport(Rng& rng) {
  const std::vector<double> supplies = random_weights(1 + rng() % 12, rng);
  const std::vector<double> demands = random_weights(1 + rng() % 12, rng);
  std::vector<double> costs_m(supplies.size() * demands.size());
  for (double& cost_m : costs_m) {
    cost_m = uniform01(rng) < 0.1 ? INFINITY : uniform(rng, 1.0, 300.0);
  }
  double best = INFINITY;
  if (const auto shipments = solve_transport(supplies, demands, costs_m)) {
    best = 0.0;
    for (const Shipment& s : *shipments) best += s.mass * costs_m[s.from * demands.size() + s.to];
  }
  fmt::print(R"({{"kind":"transport","supplies":{},"demands":{},"costs":{},"best":{}}})"
             "\n",
             list(supplies), list(demands), list(costs_m), number(best));
}

// A roadmap on the stand-in scene with all edges checked finely, so that both solvers have the
// same ones.
Roadmap random_roadmap(const Mission& mission, std::size_t samples, EdgeChecker& checker,
                       Rng& rng) {
  const PlannerSpec& spec = mission.planner;
  const RiskLimit risk{.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m};
  std::vector<Gaussian> nodes;
  for (const Mixture* mixture : {&mission.start, &mission.goal}) {
    for (const WeightedGaussian& c : mixture->components()) nodes.push_back(c.gaussian);
  }
  const std::size_t terminals = nodes.size();
  const auto drawn = sample_free(mission.world, risk, {.sigma_max_m = 4.0}, samples, rng);
  nodes.insert(nodes.end(), drawn.begin(), drawn.end());
  Roadmap roadmap = connect(std::move(nodes), 30.0, checker, terminals);
  for (std::uint32_t v = 0; v < roadmap.nodes.size(); ++v) {
    for (const Roadmap::Arc& arc : roadmap.arcs_of(v)) {
      if (arc.to < v) continue;
      if (checker.is_free(roadmap.nodes[v], roadmap.nodes[arc.to], kPlanTolerance_m)) continue;
      roadmap.close_edge(v, arc.to);
    }
  }
  return roadmap;
}

// Arcs as from, to, length, and the least time in steps.
std::string arcs_of(const Roadmap& roadmap) {
  std::vector<std::string> texts;
  for (std::uint32_t v = 0; v < roadmap.nodes.size(); ++v) {
    for (const Roadmap::Arc& arc : roadmap.arcs_of(v)) {
      if (!std::isfinite(arc.length_m)) continue;
      const Vec2 path_m = roadmap.nodes[arc.to].mean_m() - roadmap.nodes[v].mean_m();
      const double shape_m =
          std::sqrt(std::max(0.0, arc.length_m * arc.length_m - path_m.squaredNorm()));
      const double steps = std::max(path_m.norm(), shape_m) / kSpeed_mps / kStep_s;
      texts.push_back(fmt::format("[{},{},{},{}]", v, arc.to, number(arc.length_m),
                                  std::max(1, static_cast<int>(std::ceil(steps)))));
    }
  }
  return fmt::format("[{}]", fmt::join(texts, ","));
}

// False when the roadmap has too few edges for a horizon.
bool print_flow(const Mission& mission, bool timed, Rng& rng) {
  const PlannerSpec& spec = mission.planner;
  EdgeChecker checker(mission.world, {.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m});
  Roadmap roadmap = random_roadmap(mission, timed ? 80 : 200, checker, rng);
  const std::vector<double> supplies = random_weights(4, rng);
  const std::vector<double> demands = random_weights(3, rng);
  const DensityCap cap{.max_per_m2 = 2.0,
                       .robots = timed ? uniform(rng, 150.0, 300.0) : uniform(rng, 100.0, 500.0)};
  std::vector<double> capacities;
  for (const Gaussian& g : roadmap.nodes) capacities.push_back(mass_capacity(g, cap));
  double best = INFINITY;
  std::uint32_t horizon = 0;
  if (timed) {
    const TimedNetwork network(roadmap, 4, 3,
                               {.speed = {.means_mps = kSpeed_mps},
                                .step_s = kStep_s,
                                .detour = 1e6,
                                .delay_cost_mps = kDelayCost_mps},
                               checker);
    const auto free_flow = network.free_flow_steps();
    if (!free_flow) return false;
    horizon = *free_flow + static_cast<std::uint32_t>(rng() % 6);
    if (const auto moves = network.solve(horizon, {supplies, demands, capacities})) {
      best = 0.0;
      for (const TimedMove& move : *moves) {
        const bool has_arrived = move.from == move.to && move.from >= 4 && move.from < 7;
        const double waited_s = has_arrived ? 0.0 : kStep_s * (move.to_step - move.from_step);
        best += move.mass * (wasserstein2(roadmap.nodes[move.from], roadmap.nodes[move.to]) +
                             kDelayCost_mps * waited_s);
      }
    }
  } else if (const auto flow = capped_flow(roadmap, supplies, demands, cap, checker)) {
    best = flow->cost_m;
  }
  fmt::print(R"({{"kind":"{}","supplies":{},"demands":{},"capacities":{},"arcs":{},"horizon":{},)"
             R"("step_price":{},"best":{}}})"
             "\n",
             timed ? "timed" : "capped", list(supplies), list(demands), list(capacities),
             arcs_of(roadmap), horizon, kDelayCost_mps * kStep_s, number(best));
  return true;
}

int run() {
  const Mission mission =
      load_mission(SWARM_SOURCE_DIR "/deploy/missions/swarmprm_standin.yaml").value();
  Rng rng(1);
  for (int i = 0; i < 400; ++i) print_transport(rng);
  for (int i = 0; i < 400; ++i) print_flow(mission, false, rng);
  for (int i = 0; i < 200;) i += print_flow(mission, true, rng) ? 1 : 0;
  return 0;
}

}  // namespace
}  // namespace swarm::planner

int main() { return swarm::planner::run(); }
