// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The planner's parts beside what they are to be compared with, in one program on one map:
//   build/bench/bin/bench_planner
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <malloc.h>

#ifdef SWARM_WITH_OMPL
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>
#endif

#include "planner_service/planner.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarm_core/mission/mission_file.hpp"

namespace swarm::planner {
namespace {

const Mission& demo() {
  static const Mission mission =
      load_mission(SWARM_SOURCE_DIR "/deploy/missions/swarmprm_standin.yaml").value();
  return mission;
}

SteadyTime no_time() { return {}; }

void plan_once(const PlannerOptions& options, std::uint64_t seed, benchmark::State& state) {
  const Mission& mission = demo();
  Rng rng(seed);
  const auto planned = plan({mission.world, mission.start, mission.goal}, options, rng, &no_time);
  if (!planned) state.SkipWithError(planned.error().message.c_str());
}

// n = 500, r = 20 m, as in the paper.
void BM_PlanRaw(benchmark::State& state) {
  PlannerOptions options = planner_options(demo().planner);
  options.shortcuts = 0;
  std::uint64_t seed = 1;
  for (auto _ : state) plan_once(options, seed++, state);
}
BENCHMARK(BM_PlanRaw)->Unit(benchmark::kMillisecond);

void BM_PlanSmoothed(benchmark::State& state) {
  const PlannerOptions options = planner_options(demo().planner);
  std::uint64_t seed = 1;
  for (auto _ : state) plan_once(options, seed++, state);
}
BENCHMARK(BM_PlanSmoothed)->Unit(benchmark::kMillisecond);

// The radius of PRM*, proportional to √(log n / n), that is 20 m at n = 500.
void BM_PlanRawGrowth(benchmark::State& state) {
  const auto n = static_cast<double>(state.range(0));
  PlannerOptions options = planner_options(demo().planner);
  options.shortcuts = 0;
  options.samples = static_cast<std::size_t>(state.range(0));
  options.connection_radius_m =
      20.0 * std::sqrt(std::log(n) / n) / std::sqrt(std::log(500.0) / 500.0);
  std::uint64_t seed = 1;
  for (auto _ : state) plan_once(options, seed++, state);
  state.SetComplexityN(state.range(0));
}
BENCHMARK(BM_PlanRawGrowth)
    ->RangeMultiplier(2)
    ->Range(500, 8000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();

std::vector<std::pair<Gaussian, Gaussian>> some_edges() {
  const Mission& mission = demo();
  Rng rng(1);
  const auto planned = plan({mission.world, mission.start, mission.goal},
                            planner_options(mission.planner), rng, &no_time);
  std::vector<std::pair<Gaussian, Gaussian>> edges;
  const Roadmap& roadmap = planned->roadmap;
  for (std::uint32_t a = 0; a < roadmap.nodes.size(); ++a) {
    for (const auto& arc : roadmap.arcs_of(a)) {
      if (arc.to > a) edges.emplace_back(roadmap.nodes[a], roadmap.nodes[arc.to]);
    }
  }
  return edges;
}

// Proven between the samples.
void BM_EdgeCheck(benchmark::State& state) {
  const auto edges = some_edges();
  EdgeChecker checker(demo().world, planner_options(demo().planner).risk);
  std::size_t i = 0;
  for (auto _ : state) {
    const auto& [a, b] = edges[i++ % edges.size()];
    benchmark::DoNotOptimize(checker.is_free(a, b, kBuildTolerance_m));
  }
}
BENCHMARK(BM_EdgeCheck);

// The naive one: a fixed number of points, nothing known in between.
void BM_EdgeCheckFixedSteps(benchmark::State& state) {
  const auto edges = some_edges();
  const RiskLimit risk = planner_options(demo().planner).risk;
  const double k = cvar_coefficient(risk.alpha);
  std::size_t i = 0;
  for (auto _ : state) {
    const auto& [a, b] = edges[i++ % edges.size()];
    const Geodesic geodesic(a, b);
    bool free = true;
    for (int step = 0; free && step <= 20; ++step) {
      free = in_free(geodesic.at(step / 20.0), demo().world, k, risk.delta_m);
    }
    benchmark::DoNotOptimize(free);
  }
}
BENCHMARK(BM_EdgeCheckFixedSteps);

#ifdef SWARM_WITH_OMPL
// A point robot with 2 m of clearance on the same map, until the roadmap has 500 milestones.
void BM_OmplPrm500(benchmark::State& state) {
  namespace ob = ompl::base;
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ompl::RNG::setSeed(1);
  const World& world = demo().world;
  auto space = std::make_shared<ob::RealVectorStateSpace>(2);
  ob::RealVectorBounds bounds(2);
  for (const unsigned axis : {0U, 1U}) {
    bounds.setLow(axis, world.bounds_m().min_m[axis]);
    bounds.setHigh(axis, world.bounds_m().max_m[axis]);
  }
  space->setBounds(bounds);
  for (auto _ : state) {
    auto info = std::make_shared<ob::SpaceInformation>(space);
    info->setStateValidityChecker([&](const ob::State* s) {
      const auto* p = s->as<ob::RealVectorStateSpace::StateType>();
      return world.distance_m({p->values[0], p->values[1]}) > 2.0;
    });
    info->setup();
    ompl::geometric::PRM prm(info);
    auto problem = std::make_shared<ob::ProblemDefinition>(info);
    ob::ScopedState<> start(space);
    ob::ScopedState<> goal(space);
    start[0] = 25.0;
    start[1] = 20.0;
    goal[0] = 175.0;
    goal[1] = 60.0;
    problem->setStartAndGoalStates(start, goal);
    prm.setProblemDefinition(problem);
    prm.setup();
    prm.constructRoadmap(
        ob::PlannerTerminationCondition([&] { return prm.milestoneCount() >= 500; }));
    benchmark::DoNotOptimize(prm.edgeCount());
  }
}
BENCHMARK(BM_OmplPrm500)->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace swarm::planner

int main(int argc, char** argv) {
  // Memory stays with the process, for all that is measured: from 1024 samples on, half of the time
  // would be the kernel's, which hands out and takes back the same pages plan after plan.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 30);
  ::mallopt(M_TRIM_THRESHOLD, 1 << 30);
  ::mallopt(M_TOP_PAD, 64 << 20);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
