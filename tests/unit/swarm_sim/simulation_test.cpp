// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/simulation.hpp"

#include <gtest/gtest.h>

#include "swarm_monitor/audit/audit.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

Mission small_mission(std::uint32_t robots) {
  auto mission =
      load_mission(std::filesystem::path(SWARM_SOURCE_DIR) / "deploy/missions/small.yaml");
  EXPECT_TRUE(mission.has_value());
  mission->robots.count = robots;
  return *std::move(mission);
}

struct Flight {
  Outcome outcome;
  monitor::Audit audit;
  std::vector<monitor::Track> tracks;
};

Flight fly(const Mission& mission, const SimulationOptions& options) {
  Recording recording(mission, Simulation::begin_utc(), 1);
  SimulationObserver no_observer;
  auto simulation = Simulation::make(mission, options, recording, no_observer);
  EXPECT_TRUE(simulation.has_value());
  while ((*simulation)->step()) {
  }
  monitor::RecordedRun run{.mission = mission};
  run.begin = Simulation::begin_utc();
  run.tracks = recording.tracks();
  run.scenes.push_back(first_scene(mission.world.obstacles().size()));
  std::vector<monitor::Track> tracks = run.tracks;
  return {(*simulation)->outcome(), monitor::audit_recorded(std::move(run)).audit,
          std::move(tracks)};
}

SimulationOptions bad_network(std::uint64_t seed, std::size_t threads) {
  SimulationOptions options;
  options.seed = seed;
  options.threads = threads;
  options.faults = {.loss = 0.2,
                    .delay = std::chrono::milliseconds(150),
                    .jitter = std::chrono::milliseconds(50)};
  return options;
}

void expect_same(const std::vector<monitor::Track>& a, const std::vector<monitor::Track>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].points.size(), b[i].points.size()) << i;
    for (std::size_t k = 0; k < a[i].points.size(); ++k) {
      ASSERT_EQ(a[i].points[k].position_m, b[i].points[k].position_m) << i << " at " << k;
    }
  }
}

TEST(Simulation, AllArriveWithoutContact) {
  const Flight flight = fly(small_mission(12), {});

  EXPECT_EQ(flight.outcome, Outcome::kCompleted);
  EXPECT_EQ(flight.audit.arrived, 12U);
  EXPECT_EQ(flight.audit.collisions_robot + flight.audit.collisions_obstacle, 0U);
}

TEST(Simulation, TakesABadNetworkAndClocksApart) {
  SimulationOptions options = bad_network(1, 1);
  options.clocks_in_step = false;

  const Flight flight = fly(small_mission(12), options);

  EXPECT_EQ(flight.audit.arrived, 12U);
  EXPECT_EQ(flight.audit.collisions_robot + flight.audit.collisions_obstacle, 0U);
}

TEST(Simulation, IsTheSameToTheLastBitOnAnyNumberOfThreads) {
  const Mission mission = small_mission(12);

  const Flight one = fly(mission, bad_network(3, 1));
  const Flight three = fly(mission, bad_network(3, 3));

  expect_same(one.tracks, three.tracks);
}

// At 3 m/s and with a communication radius of 1.2 m robots leave each other's range all the time.
TEST(Simulation, FormsShapes) {
  for (const char* name : {"diffusion_q.yaml", "diffusion_jie.yaml"}) {
    const auto mission =
        load_mission(std::filesystem::path(SWARM_SOURCE_DIR) / "deploy/missions" / name);
    ASSERT_TRUE(mission.has_value());

    const Flight flight = fly(*mission, {});

    EXPECT_EQ(flight.outcome, Outcome::kCompleted) << name;
    EXPECT_EQ(flight.audit.arrived, mission->robots.count) << name;
    EXPECT_EQ(flight.audit.collisions_robot, 0U) << name;
  }
}

TEST(Simulation, DiffersByItsSeed) {
  const Mission mission = small_mission(12);

  const Flight one = fly(mission, bad_network(1, 1));
  const Flight two = fly(mission, bad_network(2, 1));

  EXPECT_NE(one.tracks[0].points[0].position_m, two.tracks[0].points[0].position_m);
}

TEST(Simulation, PlaysTheScript) {
  Mission mission = small_mission(6);
  mission.script = {{.at_s = 2.0, .action = CommandKind::kStop}};

  const Flight flight = fly(mission, {});

  EXPECT_EQ(flight.outcome, Outcome::kStopped);
  EXPECT_EQ(flight.tracks[0].points.back().mode, RobotMode::kStopped);
}

TEST(SimulatedNetwork, LosesItsShareAndDeliversTheRestOnceAndInTime) {
  const LinkFaults faults{.loss = 0.25,
                          .delay = std::chrono::milliseconds(150),
                          .jitter = std::chrono::milliseconds(50)};
  const SteadyTime begin{std::chrono::seconds(1)};
  SimulatedNetwork network({{0, 0}, {10, 10}}, 4.0, faults, 7, begin);
  const Duration period = std::chrono::milliseconds(100);
  constexpr std::uint32_t kSent = 4000;
  std::uint32_t received = 0;
  for (std::uint32_t k = 0; k < kSent + 10; ++k) {
    const SteadyTime now = begin + k * period;
    network.receive(RobotId(0), {5, 5}, 4.0, now - period, now, [&](const auto& report) {
      ++received;
      EXPECT_GE(now - report.as_of, std::chrono::milliseconds(100));
      EXPECT_LE(now - report.as_of, std::chrono::milliseconds(300));
    });
    if (k < kSent) {
      const std::vector<agent::NeighbourReport> sent = {
          {.robot = RobotId(1), .sequence = k, .as_of = now, .position_m = {6, 5}},
          {.robot = RobotId(2), .sequence = k, .as_of = now, .position_m = {9.5, 5}}};
      network.post(now, sent);
    }
    network.forget(now - period);
  }
  EXPECT_NEAR(received, 0.75 * kSent, 0.03 * kSent);
}

TEST(SimulatedNetwork, IsFaultyOnlyInTheInterval) {
  const LinkFaults faults{
      .loss = 1.0, .from = std::chrono::seconds(10), .until = std::chrono::seconds(20)};
  const SteadyTime begin{std::chrono::seconds(1)};
  SimulatedNetwork network({{0, 0}, {10, 10}}, 4.0, faults, 7, begin);
  std::vector<std::uint32_t> received;
  for (const std::uint32_t s : {9U, 10U, 19U, 20U}) {
    const SteadyTime now = begin + std::chrono::seconds(s);
    const std::vector<agent::NeighbourReport> sent = {
        {.robot = RobotId(1), .sequence = s, .as_of = now, .position_m = {6, 5}}};
    network.post(now, sent);
    network.receive(RobotId(0), {5, 5}, 4.0, now, now + std::chrono::seconds(1),
                    [&](const auto& report) { received.push_back(report.sequence); });
  }
  EXPECT_EQ(received, std::vector({9U, 20U}));
}

}  // namespace
}  // namespace swarm::launcher
