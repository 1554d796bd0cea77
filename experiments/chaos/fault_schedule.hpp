// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "swarmflow/core/random.hpp"
#include "swarmflow/core/time.hpp"

/// The faults of one flight of a chaos run. Pure: the same seed gives the same schedule.
namespace swarm::launcher {

enum class FaultKind : std::uint8_t {
  kKillAgent,       ///< SIGKILL of an agent process
  kFreezeAgent,     ///< SIGSTOP, and SIGCONT after `lasts`
  kHangAgent,       ///< SIGSTOP for good: the launcher is to end it
  kKillPlanner,     ///< SIGKILL
  kFreezePlanner,   ///< as for agents
  kHangPlanner,     ///< as for agents
  kFreezeLauncher,  ///< as for agents
  kKillGateway,     ///< SIGKILL
  kFreezeGateway,   ///< as for agents
  kPause,           ///< `swarm_launcher command pause`, and resume after `lasts`
  kAddObstacle,     ///< a circle of 0.4 m somewhere on the map, which stays
  kFillDisk,        ///< no space is left for the run directory
  kStepClock,       ///< the wall clock of all processes is set by `step_s`, and back after `lasts`
  kCutHosts,        ///< nothing passes between the two hosts of the flight
};
inline constexpr std::size_t kFaultKinds = 14;
std::string_view to_string(FaultKind kind);  ///< kebab-case

/// Whether robots of the process that this hits are lost: nothing brings them back.
bool loses_robots(FaultKind kind);

/// One fault.
struct Fault {
  Duration at{};     ///< since the start of the mission
  Duration lasts{};  ///< until it is undone; 0: for good
  FaultKind kind = FaultKind::kPause;
  std::uint32_t agent = 0;              ///< index of the process, for kinds that hit one
  double x_share = 0.0, y_share = 0.0;  ///< position on the map, in shares of its bounds
  std::int64_t step_s = 0;              ///< for kStepClock
};

/// How a flight is disturbed.
struct ChaosLimits {
  std::uint32_t agents = 0;  ///< processes
  bool gateway = false;      ///< the flight has a gateway
  bool two_hosts = false;    ///< the flight has two hosts
  double kill_share = 0.05;  ///< at most this share of the agents is lost
  double every_s = 1.5;      ///< mean time between faults
  double until_s = 30.0;     ///< of mission time
};

/// The faults of a flight, by time. Each agent is hit at most once, so that each lost robot has one
/// cause.
std::vector<Fault> draw_faults(const ChaosLimits& limits, Rng& rng);

}  // namespace swarm::launcher
