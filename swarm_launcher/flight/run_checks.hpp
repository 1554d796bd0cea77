// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "swarm_launcher/flight/flight_choices.hpp"
#include "swarm_launcher/processes/channel_choice.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Options that fit each other, with all that follows from them.
struct CheckedRun {
  FlightOptions options;
  ChannelChoice channel;
  std::uint32_t relays = 0;  ///< relay participants of launcher and planner each; 0: none
};

/// What this build and this host can do.
struct RunAbilities {
  bool fastdds = true;
  bool cyclonedds = true;
  bool multicast = true;  ///< of the chosen interface
};
RunAbilities abilities_of(const FlightOptions& options);

/// Refuses whatever can be refused without side effects: faults, placement, robots of other hosts,
/// channel and DDS implementations. Pure.
Result<CheckedRun> check_run(FlightOptions options, const RunAbilities& abilities);

}  // namespace swarm::launcher
