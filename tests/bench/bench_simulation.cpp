// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What control costs, one thread: a control period of a whole swarm in mid-flight on the SwarmPRM
// map. The map grows with the swarm, so that a robot has ten neighbours within reach as in the
// mission with 500. And who hears whom, by cells and by looking at everybody.
//   build/bench/bin/bench_simulation
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "swarm_core/mission/mission_file.hpp"
#include "swarm_launcher/simulation/air.hpp"
#include "swarm_launcher/simulation/simulation.hpp"

namespace swarm::launcher {
namespace {

constexpr double kRobotsOfMap = 500.0;
constexpr double kIntoFlight_s = 40.0;

Mixture scaled(const Mixture& mixture, double factor) {
  std::vector<WeightedGaussian> components;
  for (const WeightedGaussian& c : mixture.components()) {
    components.push_back({c.weight, Gaussian::make(factor * c.gaussian.mean_m(),
                                                   factor * factor * c.gaussian.covariance_m2())
                                        .value()});
  }
  return Mixture::make(std::move(components)).value();
}

Mission mission_of(std::uint32_t robots) {
  Mission mission = load_mission(SWARM_SOURCE_DIR "/deploy/missions/swarmprm_standin.yaml").value();
  const double factor = std::sqrt(robots / kRobotsOfMap);
  std::vector<Obstacle> obstacles;
  for (const Obstacle& obstacle : mission.world.obstacles()) {
    std::vector<Vec2> vertices = std::get<Polygon>(obstacle).vertices_m();
    for (Vec2& v : vertices) v *= factor;
    obstacles.emplace_back(Polygon::make(std::move(vertices)).value());
  }
  const Box& bounds = mission.world.bounds_m();
  mission.world =
      World::make({factor * bounds.min_m, factor * bounds.max_m}, std::move(obstacles)).value();
  mission.start = scaled(mission.start, factor);
  mission.goal = scaled(mission.goal, factor);
  for (double* length_m : {&mission.planner.connection_radius_m, &mission.planner.sigma_min_m,
                           &mission.planner.sigma_max_m, &mission.planner.bridge_sigma_m}) {
    *length_m *= factor;
  }
  mission.robots.count = robots;
  mission.launcher.time_limit_s = 1e4;
  return mission;
}

// Time per iteration: of one control period of all robots. `per_agent` is that for one robot.
void BM_Swarm(benchmark::State& state) {
  const auto robots = static_cast<std::uint32_t>(state.range(0));
  const Mission mission = mission_of(robots);
  Recording nothing(mission, Simulation::begin_utc(), false);
  SimulationObserver nobody;
  auto simulation = Simulation::make(mission, {}, nothing, nobody);
  if (!simulation) {
    state.SkipWithError(simulation.error().message.c_str());
    return;
  }
  while ((*simulation)->mission_s() < kIntoFlight_s && (*simulation)->step()) {
  }
  for (auto _ : state) {
    if (!(*simulation)->step()) state.SkipWithError("the mission is over");
  }
  state.counters["per_agent"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * robots,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.SetComplexityN(robots);
}
BENCHMARK(BM_Swarm)
    ->RangeMultiplier(10)
    ->Range(100, 10'000)
    ->Arg(500)
    ->Iterations(300)
    ->Unit(benchmark::kMicrosecond)
    ->Complexity();

/// Robots that all speak, as densely as a swarm in flight.
std::vector<agent::NeighbourReport> words_of(std::uint32_t robots, double side_m) {
  Rng rng(1);
  std::vector<agent::NeighbourReport> said(robots);
  for (std::uint32_t i = 0; i < robots; ++i) {
    said[i].robot = RobotId(i);
    said[i].position_m = Vec2(uniform(rng, 0.0, side_m), uniform(rng, 0.0, side_m));
  }
  return said;
}

// Without cells there is one for all, so that everybody is looked at.
void hear_all(benchmark::State& state, bool cells) {
  constexpr double kRange_m = 4.0, kArea_m2 = 2.0;
  const auto robots = static_cast<std::uint32_t>(state.range(0));
  const double side_m = std::sqrt(kArea_m2 * robots);
  const SteadyTime then;
  Air air({{0, 0}, {side_m, side_m}}, cells ? kRange_m : 2.0 * side_m, {}, 1, then);
  const std::vector<agent::NeighbourReport> said = words_of(robots, side_m);
  const SteadyTime now = then + std::chrono::milliseconds(100);
  air.post(then, said);
  for (auto _ : state) {
    std::uint64_t heard = 0;
    for (const agent::NeighbourReport& self : said) {
      air.hear(self.robot, self.position_m, kRange_m, then, now, [&](const auto&) { ++heard; });
    }
    benchmark::DoNotOptimize(heard);
  }
  state.SetComplexityN(robots);
}
void BM_HearByCells(benchmark::State& state) { hear_all(state, true); }
void BM_HearEverybody(benchmark::State& state) { hear_all(state, false); }
BENCHMARK(BM_HearByCells)->RangeMultiplier(10)->Range(100, 10'000)->Complexity();
BENCHMARK(BM_HearEverybody)->RangeMultiplier(10)->Range(100, 10'000)->Complexity();

}  // namespace
}  // namespace swarm::launcher

BENCHMARK_MAIN();
