// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "experiments/chaos/fault_schedule.hpp"

namespace swarm::launcher {

/// Whether a disturbed flight kept its promises.
struct FlightVerdict {
  std::uint32_t contacts = 0;           ///< of robots with robots, bodies and obstacles
  std::vector<std::uint32_t> lost{};    ///< robots that did not arrive and were killed
  std::vector<std::string> failures{};  ///< sentences; empty: all promises kept
};

/// Judges the summary of a flight with one robot a process: no contact, an end in time, and no
/// robot missing but those that a fault killed.
FlightVerdict judge_flight(const nlohmann::json& summary, const std::vector<Fault>& injected);

}  // namespace swarm::launcher
