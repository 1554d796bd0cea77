// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "swarmflow/core/random.hpp"

/// What a flight of a chaos run consists of, and its network. Pure: a function of the generator.
namespace swarm::launcher {

struct FlightSetup {
  /// What the flight's processes receive, for `--fault`: loss and delay; a blackout in which
  /// nothing arrives; some robots that receive nothing for a while. Empty: a perfect network.
  std::string network{};
  bool gateway = false;    ///< two robots of the other vendor, by a gateway
  bool two_hosts = false;  ///< half of the robots joins from a second host
};

/// One quarter of the flights has a gateway, another one two hosts; a flight of fewer than four
/// robots has neither.
FlightSetup draw_setup(std::uint32_t robots, Rng& rng);

}  // namespace swarm::launcher
