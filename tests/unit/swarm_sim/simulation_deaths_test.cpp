// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Robots die in lock-step, and their bodies stay where they are.
#include <algorithm>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "swarm_core/mission/scene_bodies.hpp"
#include "swarm_monitor/audit/audit.hpp"
#include "swarm_sim/simulation.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

Mission small_mission() {
  auto mission =
      load_mission(std::filesystem::path(SWARM_SOURCE_DIR) / "deploy/missions/small.yaml");
  EXPECT_TRUE(mission.has_value());
  return *std::move(mission);
}

struct RecordedCalls final : SimulationObserver {
  explicit RecordedCalls(const Mission& mission)
      : scenes{first_scene(mission.world.obstacles().size())} {}
  void on_event(UtcTime, const std::string&, bool, const std::string& code,
                const std::string& text) override {
    events.push_back(code + ": " + text);
  }
  void on_scene(const Scene& scene, const SceneChange&) override { scenes.push_back(scene); }
  bool event(const std::string& begin) const {
    return std::any_of(events.begin(), events.end(),
                       [&](const std::string& e) { return e.starts_with(begin); });
  }
  std::vector<std::string> events;
  std::vector<Scene> scenes;
};

struct Flight {
  Outcome outcome = Outcome::kNone;
  std::vector<monitor::Track> tracks{};
  RecordedCalls reported;

  std::vector<std::uint32_t> dead() const {
    std::vector<std::uint32_t> ids;
    for (const monitor::Track& track : tracks) {
      if (!track.ended_gracefully) ids.push_back(track.robot.value());
    }
    return ids;
  }
  std::size_t arrived() const {
    return static_cast<std::size_t>(
        std::count_if(tracks.begin(), tracks.end(), [](const monitor::Track& track) {
          return track.ended_gracefully && track.points.back().mode == RobotMode::kArrived;
        }));
  }
};

Flight fly(const Mission& mission, const SimulationOptions& options) {
  Recording recording(mission, Simulation::begin_utc(), 1);
  Flight flight{.reported = RecordedCalls(mission)};
  auto simulation = Simulation::make(mission, options, recording, flight.reported);
  EXPECT_TRUE(simulation.has_value());
  while ((*simulation)->step()) {
  }
  flight.outcome = (*simulation)->outcome();
  flight.tracks = recording.tracks();
  return flight;
}

/// Least gap of living robots to the bodies of the dead, from each death on. By brute force, in
/// pieces of straight motion.
double gap_to_dead_m(const Flight& flight) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const std::uint32_t id : flight.dead()) {
    const monitor::Track& dead = flight.tracks[id];
    const Vec2& rest_m = dead.points.back().position_m;
    for (const monitor::Track& track : flight.tracks) {
      if (track.robot == dead.robot) continue;
      for (std::size_t k = 1; k < track.points.size(); ++k) {
        if (track.points[k - 1].time_s < dead.points.back().time_s) continue;
        const Vec2& a = track.points[k - 1].position_m;
        const Vec2 path = track.points[k].position_m - a;
        const double length2 = path.squaredNorm();
        const double share =
            length2 > 0.0 ? std::clamp((rest_m - a).dot(path) / length2, 0.0, 1.0) : 0.0;
        const double distance_m = (a + share * path - rest_m).norm();
        least_m = std::min(least_m, distance_m - dead.radius_m - track.radius_m);
      }
    }
  }
  return least_m;
}

TEST(SimulationDeaths, LeaveBodiesThatTheOthersGetAround) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Flight flight =
        fly(small_mission(), {.seed = seed, .kills = {{.at_s = 8.0, .count = 4}}});

    EXPECT_EQ(flight.outcome, Outcome::kCompleted) << seed;
    EXPECT_EQ(flight.dead().size(), 4U) << seed;
    EXPECT_EQ(flight.arrived(), 8U) << seed;
    EXPECT_GT(gap_to_dead_m(flight), 0.0) << seed;
    const auto bodies = bodies_of(flight.reported.scenes);
    ASSERT_EQ(bodies.size(), 4U) << seed;
    for (const FallenBody& body : bodies) {
      const monitor::Track& track = flight.tracks[body.robot.value()];
      EXPECT_LE((track.points.back().position_m - body.shape.center_m).norm() + track.radius_m,
                body.shape.radius_m + 1e-9)
          << "the body is inside its circle";
      EXPECT_FALSE(body.cleared.has_value());
    }
    EXPECT_EQ(to_seconds(bodies.back().from - bodies.front().from), 3e-9)
        << "known to all at once, versions apart";
  }
}

TEST(SimulationDeaths, LeaveABodyOnTheNextOnesPath) {
  // In single file, so that the robot behind meets the body.
  Mission mission = small_mission();
  mission.robots.count = 20;
  const Flight flight = fly(mission, {.kills = {{.at_s = 6.0, .count = 2},
                                                {.at_s = 9.0, .count = 2},
                                                {.at_s = 12.0, .count = 2}}});

  EXPECT_EQ(flight.outcome, Outcome::kCompleted);
  EXPECT_EQ(flight.arrived(), 14U);
  EXPECT_GT(gap_to_dead_m(flight), 0.0);
}

// With an obstacle on a goal no plan can be made, and the paths of the last one know no bodies.
TEST(SimulationDeaths, AreDrivenAroundThoughNoPlanCanBeMade) {
  Mission mission = small_mission();
  mission.robots.count = 60;
  mission.launcher.time_limit_s = 100.0;
  mission.script = {{.at_s = 3.0, .action = SceneChange(AddObstacle{Circle{{33, 9}, 0.9}})}};
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const Flight flight = fly(mission, {.seed = seed,
                                        .kills = {{.at_s = 6.0, .count = 3},
                                                  {.at_s = 9.0, .count = 3},
                                                  {.at_s = 12.0, .count = 3}}});

    EXPECT_TRUE(flight.reported.event("replan-failed")) << seed;
    EXPECT_FALSE(flight.reported.event("silent-killed")) << seed;
    EXPECT_EQ(flight.outcome, Outcome::kCompleted) << seed;
    EXPECT_EQ(flight.arrived(), 51U) << seed;
    EXPECT_GT(gap_to_dead_m(flight), 0.0) << seed;
  }
}

TEST(SimulationDeaths, StopABodyWhenItsLastCommandRunsOut) {
  const Flight flight = fly(small_mission(), {.kills = {{.at_s = 8.0, .robots = {RobotId(5)}}}});

  ASSERT_EQ(flight.dead(), std::vector<std::uint32_t>{5});
  const auto& points = flight.tracks[5].points;
  const double died_s =
      to_seconds(bodies_of(flight.reported.scenes).at(0).from - Simulation::begin_utc());
  const auto last_tick = std::find_if(points.rbegin(), points.rend(), [&](const auto& point) {
    return point.time_s < died_s - 1e-6;
  });
  ASSERT_NE(last_tick, points.rend());
  EXPECT_NEAR(points.back().time_s - last_tick->time_s, 0.2, 1e-6) << "two control periods";
  EXPECT_LE((points.back().position_m - last_tick->position_m).norm(), 1.5 * 0.2 + 1e-9);
}

TEST(SimulationDeaths, OfRobotsThatComeBackAreNoObstaclesAnyMore) {
  Mission mission = small_mission();
  mission.launcher.respawn_agent_max = 1;
  const Flight flight = fly(mission, {.kills = {{.at_s = 8.0, .count = 4}}});

  EXPECT_EQ(flight.outcome, Outcome::kCompleted);
  EXPECT_TRUE(flight.dead().empty());
  EXPECT_EQ(flight.arrived(), 12U);
  const auto bodies = bodies_of(flight.reported.scenes);
  ASSERT_EQ(bodies.size(), 4U);
  for (const FallenBody& body : bodies) {
    ASSERT_TRUE(body.cleared.has_value());
    // Started again after 0.3 s, received a period or two later.
    EXPECT_NEAR(to_seconds(*body.cleared - body.from), 0.5, 0.15);
  }
}

TEST(SimulationDeaths, CanBeClearedByTheScript) {
  Mission mission = small_mission();
  mission.script = {{.at_s = 9.0, .action = SceneChange(ClearBody{RobotId(5)})},
                    {.at_s = 9.5, .action = SceneChange(ClearBody{RobotId(6)})}};
  const Flight flight = fly(mission, {.kills = {{.at_s = 8.0, .robots = {RobotId(5)}}}});

  const auto bodies = bodies_of(flight.reported.scenes);
  ASSERT_EQ(bodies.size(), 1U);
  ASSERT_TRUE(bodies[0].cleared.has_value());
  EXPECT_NEAR(to_seconds(*bodies[0].cleared - bodies[0].from), 1.0, 0.11);
  EXPECT_TRUE(flight.reported.event("scene-refused: robot 6 has no body"));
}

TEST(SimulationDeaths, AreTheSameOnAnyNumberOfThreads) {
  const auto flown = [](std::size_t threads) {
    SimulationOptions options{.seed = 7,
                              .faults = {.loss = 0.2, .delay = std::chrono::milliseconds(150)},
                              .clocks_in_step = false,
                              .threads = threads,
                              .kills = {{.at_s = 5.0, .count = 2}, {.at_s = 9.0, .count = 3}}};
    Mission mission = small_mission();
    mission.launcher.respawn_agent_max = 1;
    return fly(mission, options);
  };
  const Flight one = flown(1);
  const Flight three = flown(3);

  ASSERT_EQ(one.reported.events, three.reported.events);
  for (std::size_t i = 0; i < one.tracks.size(); ++i) {
    ASSERT_EQ(one.tracks[i].points.size(), three.tracks[i].points.size()) << i;
    for (std::size_t k = 0; k < one.tracks[i].points.size(); ++k) {
      ASSERT_EQ(one.tracks[i].points[k].position_m, three.tracks[i].points[k].position_m);
    }
  }
}

TEST(SimulationDeaths, DoNotChangeAFlightBeforeThem) {
  const Flight with = fly(small_mission(), {.kills = {{.at_s = 8.0, .count = 4}}});
  const Flight without = fly(small_mission(), {});

  for (std::size_t i = 0; i < with.tracks.size(); ++i) {
    for (std::size_t k = 0; k < with.tracks[i].points.size(); ++k) {
      if (with.tracks[i].points[k].time_s > 7.9) break;
      ASSERT_EQ(with.tracks[i].points[k].position_m, without.tracks[i].points[k].position_m);
    }
  }
}

}  // namespace
}  // namespace swarm::launcher
