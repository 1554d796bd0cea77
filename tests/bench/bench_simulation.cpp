// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Cost of control: a control period of a whole swarm in mid-flight, of 500 robots on the SwarmPRM
// map and of any number on an open one. And cost of reception: states by cells, compared with a
// scan of all states.
//   build/bench/bin/bench_simulation
#include <cmath>
#include <numbers>
#include <vector>

#include <benchmark/benchmark.h>

#include "swarm_sim/simulated_network.hpp"
#include "swarm_sim/simulation.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

constexpr double kIntoFlight_s = 40.0;

/// The SwarmPRM map with the largest number of robots in the paper.
Mission standin_mission() {
  Mission mission = load_mission(SWARM_SOURCE_DIR "/deploy/missions/swarmprm_standin.yaml").value();
  mission.robots.count = 500;
  return mission;
}

/// A swarm that crosses an open map, at the same density for any number of robots: except at the
/// rim, the neighbourhood of a robot is the same.
Mission open_mission(std::uint32_t robots) {
  constexpr double kAreaEach_m2 = 2.0, kPath_m = 150.0;
  Mission mission = standin_mission();
  const double sigma_m = std::sqrt(kAreaEach_m2 * robots / (4.0 * std::numbers::pi));
  const double side_m = 8.0 * sigma_m;
  const auto dense_region_at = [&](double x_m) {
    const Mat2 covariance_m2 = sigma_m * sigma_m * Mat2::Identity();
    return Mixture::make({{1.0, Gaussian::make(Vec2(x_m, 0.5 * side_m), covariance_m2).value()}})
        .value();
  };
  mission.world = World::make({{0.0, 0.0}, {side_m + kPath_m, side_m}}, {}).value();
  mission.start = dense_region_at(0.5 * side_m);
  mission.goal = dense_region_at(0.5 * side_m + kPath_m);
  mission.planner.options.set("sigma_min_m", 0.9 * sigma_m);
  mission.planner.options.set("sigma_max_m", 1.1 * sigma_m);
  mission.planner.options.set("connection_radius_m", 2.0 * kPath_m);
  mission.planner.options.set("bridge_share", 0.0);
  mission.robots.count = robots;
  mission.launcher.time_limit_s = 1e4;
  return mission;
}

// Time per iteration is that of one control period of all robots; `per_agent`, that of one robot.
void fly_on(benchmark::State& state, const Mission& mission, std::size_t threads) {
  Recording nothing(mission, Simulation::begin_utc(), Recording::kFirstAndLast);
  SimulationObserver no_observer;
  SimulationOptions options;
  options.threads = threads;
  auto simulation = Simulation::make(mission, options, nothing, no_observer);
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
      benchmark::Counter(static_cast<double>(state.iterations()) * mission.robots.count,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.SetComplexityN(mission.robots.count);
}

void BM_Swarm(benchmark::State& state) { fly_on(state, standin_mission(), 1); }
BENCHMARK(BM_Swarm)->Iterations(300)->Unit(benchmark::kMicrosecond);

void BM_OpenMap(benchmark::State& state) {
  fly_on(state, open_mission(static_cast<std::uint32_t>(state.range(0))), 1);
}
BENCHMARK(BM_OpenMap)
    ->RangeMultiplier(10)
    ->Range(100, 10'000)
    ->Iterations(300)
    ->Unit(benchmark::kMicrosecond)
    ->Complexity();

/// With as many threads as `simulate` takes by itself.
void BM_OpenMapByAllCores(benchmark::State& state) {
  const auto robots = static_cast<std::uint32_t>(state.range(0));
  fly_on(state, open_mission(robots), useful_threads(robots));
}
BENCHMARK(BM_OpenMapByAllCores)
    ->RangeMultiplier(10)
    ->Range(100, 10'000)
    ->Iterations(300)
    ->Unit(benchmark::kMicrosecond)
    ->UseRealTime()
    ->Complexity();

/// Robots that all publish, as densely as a swarm in flight.
std::vector<agent::NeighbourReport> reports_of(std::uint32_t robots, double side_m) {
  Rng rng(1);
  std::vector<agent::NeighbourReport> sent(robots);
  for (std::uint32_t i = 0; i < robots; ++i) {
    sent[i].robot = RobotId(i);
    sent[i].position_m = Vec2(uniform(rng, 0.0, side_m), uniform(rng, 0.0, side_m));
  }
  return sent;
}

// Without cells there is one for all, so that all states are scanned.
void receive_all(benchmark::State& state, bool cells) {
  constexpr double kRange_m = 4.0, kArea_m2 = 2.0;
  const auto robots = static_cast<std::uint32_t>(state.range(0));
  const double side_m = std::sqrt(kArea_m2 * robots);
  const SteadyTime then;
  SimulatedNetwork network({{0, 0}, {side_m, side_m}}, cells ? kRange_m : 2.0 * side_m, {}, 1,
                           then);
  const std::vector<agent::NeighbourReport> sent = reports_of(robots, side_m);
  const SteadyTime now = then + std::chrono::milliseconds(100);
  network.post(then, sent);
  for (auto _ : state) {
    std::uint64_t received = 0;
    for (const agent::NeighbourReport& self : sent) {
      network.receive(self.robot, self.position_m, kRange_m, then, now,
                      [&](const auto&) { ++received; });
    }
    benchmark::DoNotOptimize(received);
  }
  state.SetComplexityN(robots);
}
void BM_ReceiveByCells(benchmark::State& state) { receive_all(state, true); }
void BM_ReceiveFromAll(benchmark::State& state) { receive_all(state, false); }
BENCHMARK(BM_ReceiveByCells)->RangeMultiplier(10)->Range(100, 10'000)->Complexity();
BENCHMARK(BM_ReceiveFromAll)->RangeMultiplier(10)->Range(100, 10'000)->Complexity();

}  // namespace
}  // namespace swarm::launcher

BENCHMARK_MAIN();
