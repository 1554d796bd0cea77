// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "experiments/chaos/chaos_means.hpp"
#include "experiments/chaos/fault_schedule.hpp"
#include "experiments/chaos/flight_setup.hpp"
#include "swarmflow/core/box.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// One disturbed flight.
struct ChaosFlightSpec {
  std::filesystem::path mission;
  std::filesystem::path dir;  ///< run directory, which it makes
  std::uint32_t robots = 0;
  std::uint64_t seed = 1;
  Box bounds_m;  ///< of the map, for obstacles
  FlightSetup setup{};
  std::vector<Fault> faults{};
};

/// What became of it.
struct DisturbedFlight {
  std::vector<Fault> injected{};  ///< without those whose target had ended by then
  bool interrupted = false;       ///< by the user
};

/// Flies it with processes of its own, to its end or for ten minutes, after which it is killed. A
/// stop signal ends it in order, a second one at once; none of its processes outlives this call.
/// The faults are logged to `<dir>.chaos.jsonl`. \pre setup and faults need only what the means
/// have, but for disks and clocks, which are left alone then
Result<DisturbedFlight> fly_disturbed(const ChaosFlightSpec& spec, const ChaosMeans& means);

}  // namespace swarm::launcher
