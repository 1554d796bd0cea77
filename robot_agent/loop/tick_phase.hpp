// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace swarm::agent {

/// The share of a control period, in [0, 1), by which robot or process `number` ticks after the
/// period's begin, so that not all want the processor at once: multiples of the golden ratio spread
/// any number of them evenly over the period.
inline double tick_phase(std::uint32_t number) {
  const double turns = number * (std::numbers::phi - 1.0);
  return turns - std::floor(turns);
}

}  // namespace swarm::agent
