// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "experiments/chaos/fault_schedule.hpp"

namespace swarm::launcher {

/// A robot that did not arrive, and the fault that explains it.
struct LostRobot {
  std::uint32_t robot = 0;
  std::string why{};  ///< empty: no fault does
};

/// Whether a disturbed flight kept its promises.
struct FlightVerdict {
  std::uint32_t contacts = 0;  ///< of robots with robots, bodies and obstacles
  std::vector<LostRobot> lost{};
  std::vector<std::string> failures{};  ///< sentences; empty: all promises kept
};

/// Judges the summary of a flight with one robot a process: no contact, an end in time, no robot
/// missing but those that a fault took, and no record missing unless the disk was full.
FlightVerdict judge_flight(const nlohmann::json& summary, const std::vector<Fault>& injected);

}  // namespace swarm::launcher
