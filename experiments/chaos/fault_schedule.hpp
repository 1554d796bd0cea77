// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "swarmflow/core/random.hpp"
#include "swarmflow/core/time.hpp"

/// The faults of one flight of a chaos run. Pure: the same seed gives the same schedule.
namespace swarm::launcher {

enum class FaultKind : std::uint8_t {
  kKillAgent,       ///< SIGKILL of an agent process
  kFreezeAgent,     ///< SIGSTOP, and SIGCONT after `lasts`
  kKillPlanner,     ///< SIGKILL
  kFreezePlanner,   ///< as for agents
  kFreezeLauncher,  ///< as for agents
  kPause,           ///< `swarm_launcher command pause`, and resume after `lasts`
  kAddObstacle,     ///< a circle of 0.4 m somewhere on the map, removed after `lasts`
};
std::string_view to_string(FaultKind kind);  ///< kebab-case

/// One fault.
struct Fault {
  Duration at{};     ///< since the start of the mission
  Duration lasts{};  ///< until it is undone; 0: for good
  FaultKind kind = FaultKind::kPause;
  std::uint32_t agent = 0;              ///< index of the process, for kinds that hit one
  double x_share = 0.0, y_share = 0.0;  ///< place on the map, in shares of its bounds
};

/// How a flight is disturbed.
struct ChaosLimits {
  std::uint32_t agents = 0;  ///< processes
  double kill_share = 0.05;  ///< at most this share of them is killed
  double every_s = 1.5;      ///< mean time between faults
  double until_s = 30.0;     ///< of mission time
};

/// The faults of a flight, by time. Each agent is hit at most once, so that each lost robot has one
/// cause.
std::vector<Fault> draw_faults(const ChaosLimits& limits, Rng& rng);

/// What the flight's processes receive: loss, delay, and a blackout in which nothing arrives; for
/// `--fault`, empty for a perfect network.
std::string draw_network(Rng& rng);

}  // namespace swarm::launcher
