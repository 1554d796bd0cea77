// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Geometry has no scale: a mission whose lengths and speeds are all multiplied by a factor behaves
// alike, with the same times.
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "swarm_monitor/audit/audit.hpp"
#include "swarm_sim/simulation.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

/// A hall with a gate, in which robots of 0.2 m drive at 1.5 m/s, times a factor. Every length of
/// the mission is written, since the defaults of keys are those of the default body.
std::string hall(double scale) {
  const auto m = [scale](double length_m) { return fmt::format("{:.17g}", scale * length_m); };
  const auto m2 = [scale](double area_m2) {
    return fmt::format("{:.17g}", scale * scale * area_m2);
  };
  const auto component = [&](double x_m, double y_m, double weight) {
    return fmt::format("  - {{mean_m: [{}, {}], covariance_m2: [[{}, 0], [0, {}]], weight: {}}}\n",
                       m(x_m), m(y_m), m2(2.0), m2(2.0), weight);
  };
  std::string text = "version: 1\nname: hall\n";
  text += fmt::format("world:\n  bounds_m: [0, 0, {}, {}]\n  obstacles:\n", m(40), m(30));
  text += fmt::format("    - polygon_m: [[{}, {}], [{}, {}], [{}, {}], [{}, {}]]\n", m(17), m(30),
                      m(17), m(17), m(23), m(17), m(23), m(30));
  text += fmt::format("    - polygon_m: [[{}, {}], [{}, {}], [{}, {}], [{}, {}]]\n", m(17), m(0),
                      m(23), m(0), m(23), m(9), m(17), m(9));
  text += fmt::format(
      "robots: {{count: 12, radius_m: {}, speed_max_mps: {}, placement_gap_m: {}, "
      "position_noise_m: {}}}\n",
      m(0.2), m(1.5), m(0.7), m(0.01));
  text += "start:\n" + component(7, 15, 1);
  text += "goal:\n" + component(33, 21, 0.5) + component(33, 8, 0.5);
  text += fmt::format(
      "planner: {{samples: 300, connection_radius_m: {}, risk_delta_m: {}, sigma_min_m: {}, "
      "sigma_max_m: {}, bridge_sigma_m: {}, speed_mps: {}}}\n",
      m(8), m(-0.2), m(0.5), m(2), m(4), m(1.25));
  text += fmt::format(
      "control: {{cruise_mps: {}, keep_clearance_m: {}, neighbour_gap_m: {}, "
      "neighbour_push_mps: {}, obstacle_gap_m: {}, obstacle_push_mps: {}, escape_spread_m: {}}}\n",
      m(1.45), m(1), m(1), m(0.6), m(0.5), m(1), m(4));
  text +=
      fmt::format("safety: {{neighbour_margin_m: {}, obstacle_margin_m: {}}}\n", m(0.25), m(0.05));
  text += fmt::format(
      "link: {{cell_size_m: {}, communication_radius_m: {}, join_margin_m: {}, leave_margin_m: {}, "
      "group_cell_size_m: {}, send_error_m: {}, send_near_m: {}}}\n",
      m(100), m(4), m(6), m(9), m(20), m(0.05), m(1));  // cells of 1 m at least
  return text + "launcher: {time_limit_s: 120}\n";
}

struct Flight {
  Outcome outcome{};
  double mission_s = 0.0;
  monitor::Audit audit;
};

Flight fly(double scale, std::uint64_t seed) {
  const auto mission = parse_mission(hall(scale), "hall.yaml");
  EXPECT_TRUE(mission) << (mission ? "" : mission.error().message);
  if (!mission) return {};
  Recording recording(*mission, Simulation::begin_utc(), 1);
  SimulationObserver no_observer;
  SimulationOptions options;
  options.seed = seed;
  auto simulation = Simulation::make(*mission, options, recording, no_observer);
  EXPECT_TRUE(simulation) << (simulation ? "" : simulation.error().message);
  if (!simulation) return {};
  while ((*simulation)->step()) {
  }
  monitor::RecordedRun run{.mission = *mission};
  run.begin = Simulation::begin_utc();
  run.tracks = recording.tracks();
  run.scenes.push_back(first_scene(mission->world.obstacles().size()));
  return {(*simulation)->outcome(), (*simulation)->mission_s(),
          monitor::audit_recorded(std::move(run)).audit};
}

TEST(Scale, OfAMissionChangesNothing) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const Flight usual = fly(1.0, seed);
    ASSERT_EQ(usual.outcome, Outcome::kCompleted);
    for (const double scale : {0.05, 20.0}) {
      const Flight flight = fly(scale, seed);
      EXPECT_EQ(flight.outcome, Outcome::kCompleted) << scale << " seed " << seed;
      EXPECT_EQ(flight.audit.arrived, 12U) << scale << " seed " << seed;
      EXPECT_EQ(flight.audit.collisions_robot + flight.audit.collisions_obstacle, 0U) << scale;
      EXPECT_NEAR(flight.mission_s, usual.mission_s, 0.1 * usual.mission_s)
          << scale << " seed " << seed;
    }
  }
}

}  // namespace
}  // namespace swarm::launcher
