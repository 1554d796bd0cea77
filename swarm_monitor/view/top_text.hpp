// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "swarm_monitor/view/swarm_state.hpp"

namespace swarm::monitor {

struct TopFacts {
  std::string name{};      ///< of the mission
  double states_hz = 0.0;  ///< received in the last second
  Histogram latency{};     ///< of those
  std::size_t rows = 10;   ///< robots, the nearest to another first
  std::size_t events = 5;
};

/// The state of a swarm as text for a terminal.
std::string top_text(const SwarmState& state, const TopFacts& facts, UtcTime now);

}  // namespace swarm::monitor
