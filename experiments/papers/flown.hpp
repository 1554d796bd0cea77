// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "swarm_sim/simulation.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::launcher {

/// Results of one simulated and audited mission that a table uses.
struct Flown {
  std::uint64_t seed = 0;
  Outcome outcome = Outcome::kNone;
  std::uint32_t robots = 0;
  std::uint32_t arrived = 0;       ///< robots at their goal at the end
  std::uint32_t contacts = 0;      ///< pairs of robots, and robots with obstacles
  double wall_s = 0.0;             ///< planning and flying
  double plan_ms = 0.0;            ///< of all plans of the flight
  double ns_per_agent_step = 0.0;  ///< median over the steps
  double mission_s = 0.0;
  double path_m = 0.0;   ///< mean over the robots
  double bound_m = 0.0;  ///< geodesic lower bound, between the robots' own starts and ends
  double robot_gap_m = 0.0;
  double obstacle_gap_m = 0.0;
  /// Mean over the robots of the least clearance of each, at most 2 m.
  double clearance_m = 0.0;
  /// Share of robot-time nearer to an obstacle than planner.risk_delta_m allows: −sdf > δ.
  double risk_share = 0.0;
  // How the published plan was kept (monitor::Tracking); NaN where it was not measured.
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  double w2_m = kUnknown;        ///< of the swarm to χ(τ), mean over time
  double w2_floor_m = kUnknown;  ///< of two samples of χ(τ)
  double centre_lag_s = kUnknown;
  double lag_p90_s = kUnknown;
  double density_per_m2 = kUnknown;          ///< largest executed, discs of 2 m radius
  double density_p95_per_m2 = kUnknown;      ///< the same, 95th percentile over time
  double planned_density_per_m2 = kUnknown;  ///< largest of the plan, the same discs
  double over_plan_s = kUnknown;             ///< mission time minus the plan's duration
  /// E = max (F + G) over the robots, of shapes that are filled.
  std::vector<double> energy_m2{};
  static constexpr double kEnergyEvery_s = 0.1;
  // Only of a flight that is drawn:
  std::string paths_svg{};
  std::vector<double> robot_gaps_m{};     ///< least gap of each robot to others, at most 2 m
  std::vector<double> obstacle_gaps_m{};  ///< and to obstacles

  /// Path length over its lower bound: comparable between maps, unlike the metres.
  double ratio() const { return bound_m > 0.0 ? path_m / bound_m : 0.0; }
  /// 1 means that the swarm follows the plan as closely as a sample of it would.
  double w2_ratio() const { return w2_m / w2_floor_m; }
};

/// Simulates and audits in memory.
Result<Flown> fly(const Mission& mission, const SimulationOptions& options, bool draw);

/// The same for seeds 1 … `seeds` of each mission, one flight of each in turn, as many at a time as
/// there are cores; those of seed 1 are drawn. Fails if one of them cannot be planned. `done` is
/// called for each, by one thread at a time.
Result<std::vector<std::vector<Flown>>> fly_in_turns(std::span<const Mission> missions,
                                                     std::uint32_t seeds,
                                                     const SimulationOptions& options,
                                                     const std::function<void(const Flown&)>& done);

}  // namespace swarm::launcher
