// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The planner's parts, each with a naive version for comparison, on one map:
//   build/bench/bin/bench_planner
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>
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

#include "planner_service/methods/swarmprm/swarmprm_method.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "planner_service/roadmap/live_roadmap.hpp"
#include "planner_service/roadmap/neighbours.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace {

// Bytes allocated by operator new and not freed yet, and their maximum.
bool counting = false;
std::size_t heap_now = 0;
std::size_t heap_peak = 0;

void* counted_new(std::size_t size) {
  void* memory = std::malloc(size);
  if (memory == nullptr) std::abort();
  if (counting) {
    heap_now += ::malloc_usable_size(memory);
    heap_peak = std::max(heap_peak, heap_now);
  }
  return memory;
}

void counted_delete(void* memory) {
  if (counting && memory != nullptr) heap_now -= std::min(heap_now, ::malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return counted_new(size); }
void* operator new[](std::size_t size) { return counted_new(size); }
void operator delete(void* memory) noexcept { counted_delete(memory); }
void operator delete[](void* memory) noexcept { counted_delete(memory); }
void operator delete(void* memory, std::size_t) noexcept { counted_delete(memory); }
void operator delete[](void* memory, std::size_t) noexcept { counted_delete(memory); }

namespace swarm::planner {
namespace {

const Mission& demo() {
  static const Mission mission =
      load_mission(SWARM_SOURCE_DIR "/deploy/missions/swarmprm_standin.yaml").value();
  return mission;
}

// Without bodies, neither speed nor density of a plan is limited.
SwarmPrmOptions demo_options() {
  SwarmPrmOptions options = swarmprm_options({.mission = demo(), .limits = {}});
  options.cap_is_automatic = false;
  options.speed_mps = demo().planner.speed_mps;
  options.keeps_roadmap = false;
  return options;
}

Result<PlanResult> plan_once(const PlanRequest& request, const SwarmPrmOptions& options, Rng& rng) {
  return SwarmPrmMethod(options).plan(request, {rng, [] { return SteadyTime{}; }});
}

void plan_once(const SwarmPrmOptions& options, std::uint64_t seed, benchmark::State& state) {
  const Mission& mission = demo();
  Rng rng(seed);
  const auto planned = plan_once({mission.world, mission.start, mission.goal}, options, rng);
  if (!planned) state.SkipWithError(planned.error().message.c_str());
}

// n = 500, r = 20 m, as in the paper.
void BM_PlanRaw(benchmark::State& state) {
  SwarmPrmOptions options = demo_options();
  options.shortcuts = 0;
  std::uint64_t seed = 1;
  for (auto _ : state) plan_once(options, seed++, state);
}
BENCHMARK(BM_PlanRaw)->Unit(benchmark::kMillisecond);

void BM_PlanSmoothed(benchmark::State& state) {
  const SwarmPrmOptions options = demo_options();
  std::uint64_t seed = 1;
  for (auto _ : state) plan_once(options, seed++, state);
}
BENCHMARK(BM_PlanSmoothed)->Unit(benchmark::kMillisecond);

// The radius of PRM*, proportional to √(log n / n), that is 20 m at n = 500.
double prm_star_radius_m(double n) {
  return 20.0 * std::sqrt(std::log(n) / n) / std::sqrt(std::log(500.0) / 500.0);
}

void BM_PlanRawGrowth(benchmark::State& state) {
  const auto n = static_cast<double>(state.range(0));
  SwarmPrmOptions options = demo_options();
  options.shortcuts = 0;
  options.samples = static_cast<std::size_t>(state.range(0));
  options.connection_radius_m = prm_star_radius_m(n);
  std::uint64_t seed = 1;
  for (auto _ : state) plan_once(options, seed++, state);
  state.SetComplexityN(state.range(0));
  // Once more, to measure the heap: the largest memory that a plan needs.
  heap_now = heap_peak = 0;
  counting = true;
  plan_once(options, 1, state);
  counting = false;
  state.counters["peak_bytes_per_sample"] = static_cast<double>(heap_peak) / n;
}
BENCHMARK(BM_PlanRawGrowth)
    ->RangeMultiplier(2)
    ->Range(500, 8000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();

std::vector<Gaussian> some_nodes(std::size_t count) {
  const SwarmPrmOptions options = demo_options();
  Rng rng(1);
  return sample_free(demo().world, options.risk, options.sampler, count, rng);
}

void BM_Neighbours(benchmark::State& state) {
  const auto nodes = some_nodes(static_cast<std::size_t>(state.range(0)));
  const double radius_m = prm_star_radius_m(static_cast<double>(nodes.size()));
  for (auto _ : state) benchmark::DoNotOptimize(find_neighbours(nodes, radius_m));
}
BENCHMARK(BM_Neighbours)->Arg(500)->Arg(8000)->Unit(benchmark::kMicrosecond);

// The naive version: all pairs.
void BM_NeighboursAllPairs(benchmark::State& state) {
  const auto nodes = some_nodes(static_cast<std::size_t>(state.range(0)));
  const double radius_m = prm_star_radius_m(static_cast<double>(nodes.size()));
  for (auto _ : state) {
    std::vector<NeighbourPair> pairs;
    for (std::uint32_t a = 0; a < nodes.size(); ++a) {
      for (std::uint32_t b = a + 1; b < nodes.size(); ++b) {
        const double distance_m = wasserstein2(nodes[a], nodes[b]);
        if (distance_m <= radius_m) pairs.push_back({a, b, distance_m});
      }
    }
    benchmark::DoNotOptimize(pairs);
  }
}
BENCHMARK(BM_NeighboursAllPairs)->Arg(500)->Arg(8000)->Unit(benchmark::kMicrosecond);

// A number of small obstacles all over the map.
std::vector<Box> pebbles(std::size_t count) {
  Rng rng(1);
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 at(uniform(rng, 0, 200), uniform(rng, 0, 160));
    boxes.push_back({at, at + Vec2(1, 1)});
  }
  return boxes;
}

template <class Query>
void query_boxes(benchmark::State& state, Query&& query) {
  Rng rng(2);
  std::vector<Box> places;
  for (int i = 0; i < 1000; ++i) {
    const Vec2 at(uniform(rng, 0, 200), uniform(rng, 0, 160));
    places.push_back({at, at + Vec2(10, 10)});
  }
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(query(places[i++ % places.size()]));
}

constexpr double kPlaceReach_m = 6.0;

void BM_BoxQuery(benchmark::State& state) {
  const BoxIndex index(pebbles(static_cast<std::size_t>(state.range(0))));
  query_boxes(state, [&](const Box& place) {
    std::uint32_t found = 0;
    index.any_within(place, kPlaceReach_m, [&](std::uint32_t) { return ++found, false; });
    return found;
  });
}
BENCHMARK(BM_BoxQuery)->Arg(6)->Arg(11)->Arg(16)->Arg(24)->Arg(50)->Arg(100)->Arg(10'000);

// The naive version: all boxes at each query.
void BM_BoxScan(benchmark::State& state) {
  const auto boxes = pebbles(static_cast<std::size_t>(state.range(0)));
  query_boxes(state, [&](const Box& place) {
    std::uint32_t found = 0;
    for (const Box& box : boxes) {
      found += place.gap_squared_m2(box) <= kPlaceReach_m * kPlaceReach_m ? 1U : 0U;
    }
    return found;
  });
}
BENCHMARK(BM_BoxScan)->Arg(6)->Arg(11)->Arg(16)->Arg(24)->Arg(50)->Arg(100)->Arg(10'000);

// The blocks of the demo, made of small obstacles.
World pebble_world(std::size_t count) {
  const World& blocks = demo().world;
  const double spacing_m = std::sqrt(10'525.0 / static_cast<double>(count));
  std::vector<Obstacle> obstacles;
  for (double x = 0.5 * spacing_m; x < 200.0; x += spacing_m) {
    for (double y = 0.5 * spacing_m; y < 160.0; y += spacing_m) {
      if (blocks.distance_m({x, y}) < 0.0) obstacles.emplace_back(Circle{{x, y}, 0.5 * spacing_m});
    }
  }
  return World::make(blocks.bounds_m(), std::move(obstacles)).value();
}

void BM_PlanAmongPebbles(benchmark::State& state) {
  const World world = pebble_world(static_cast<std::size_t>(state.range(0)));
  SwarmPrmOptions options = demo_options();
  options.shortcuts = 0;
  std::uint64_t seed = 1;
  for (auto _ : state) {
    Rng rng(seed++);
    const auto planned = plan_once({world, demo().start, demo().goal}, options, rng);
    if (!planned) state.SkipWithError(planned.error().message.c_str());
  }
}
BENCHMARK(BM_PlanAmongPebbles)->Arg(100)->Arg(1000)->Arg(10'000)->Unit(benchmark::kMillisecond);

LiveRoadmapOptions live_options(std::size_t samples) {
  const SwarmPrmOptions options = demo_options();
  return {.samples = samples,
          .connection_radius_m = prm_star_radius_m(static_cast<double>(samples)),
          .risk = options.risk,
          .sampler = options.sampler};
}

std::vector<Gaussian> terminals() {
  std::vector<Gaussian> terminals;
  for (const Mixture* mixture : {&demo().start, &demo().goal}) {
    for (const auto& component : mixture->components()) terminals.push_back(component.gaussian);
  }
  return terminals;
}

World with_circle(double y) {
  std::vector<Obstacle> obstacles = demo().world.obstacles();
  obstacles.emplace_back(Circle{{100, y}, 3.0});
  return World::make(demo().world.bounds_m(), std::move(obstacles)).value();
}

// An obstacle moves along the main passage, half a metre a step; a roadmap for the search after
// every step.
void BM_RoadmapRepaired(benchmark::State& state) {
  Rng rng(1);
  LiveRoadmap live(demo().world, terminals(),
                   live_options(static_cast<std::size_t>(state.range(0))), rng);
  std::size_t step = 0;
  double checks = 0.0;
  for (auto _ : state) {
    live.update(with_circle(103.0 + 0.5 * static_cast<double>(step++ % 28)), terminals(), rng);
    checks += static_cast<double>(live.work().edges_checked);
    benchmark::DoNotOptimize(live.roadmap());
  }
  state.counters["edges_checked"] = benchmark::Counter(checks, benchmark::Counter::kAvgIterations);
}
BENCHMARK(BM_RoadmapRepaired)->Arg(500)->Arg(8000)->Unit(benchmark::kMicrosecond);

// The naive version: builds the roadmap again.
void BM_RoadmapRebuilt(benchmark::State& state) {
  Rng rng(1);
  std::size_t step = 0;
  double checks = 0.0;
  for (auto _ : state) {
    LiveRoadmap live(with_circle(103.0 + 0.5 * static_cast<double>(step++ % 28)), terminals(),
                     live_options(static_cast<std::size_t>(state.range(0))), rng);
    checks += static_cast<double>(live.work().edges_checked);
    benchmark::DoNotOptimize(live.roadmap());
  }
  state.counters["edges_checked"] = benchmark::Counter(checks, benchmark::Counter::kAvgIterations);
}
BENCHMARK(BM_RoadmapRebuilt)->Arg(500)->Arg(8000)->Unit(benchmark::kMicrosecond);

std::vector<std::pair<Gaussian, Gaussian>> some_edges() {
  const Mission& mission = demo();
  Rng rng(1);
  const auto planned = plan_once({mission.world, mission.start, mission.goal}, demo_options(), rng);
  std::vector<std::pair<Gaussian, Gaussian>> edges;
  const Roadmap& roadmap = planned->roadmap;
  for (std::uint32_t a = 0; a < roadmap.nodes.size(); ++a) {
    for (const auto& arc : roadmap.arcs_of(a)) {
      if (arc.to > a) edges.emplace_back(roadmap.nodes[a], roadmap.nodes[arc.to]);
    }
  }
  return edges;
}

// With a bound that holds between the samples.
void BM_EdgeCheck(benchmark::State& state) {
  const auto edges = some_edges();
  EdgeChecker checker(demo().world, demo_options().risk);
  std::size_t i = 0;
  for (auto _ : state) {
    const auto& [a, b] = edges[i++ % edges.size()];
    benchmark::DoNotOptimize(checker.is_free(a, b, kBuildTolerance_m));
  }
}
BENCHMARK(BM_EdgeCheck);

// The naive version: a fixed number of points, without a bound in between.
void BM_EdgeCheckFixedSteps(benchmark::State& state) {
  const auto edges = some_edges();
  const RiskLimit risk = demo_options().risk;
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
  // Freed memory stays with the process: otherwise, from 1024 samples on, the kernel would take
  // half of the measured time to map and unmap the same pages, plan after plan.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 30);
  ::mallopt(M_TRIM_THRESHOLD, 1 << 30);
  ::mallopt(M_TOP_PAD, 64 << 20);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
