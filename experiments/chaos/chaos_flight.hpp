// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/chaos/fault_schedule.hpp"
#include "swarmflow/core/box.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// One disturbed flight.
struct ChaosFlightSpec {
  std::filesystem::path mission;
  std::filesystem::path dir;  ///< run directory, which it makes
  std::uint32_t robots = 0;
  std::uint64_t seed = 1;
  Box bounds_m;           ///< of the map, for obstacles
  std::string network{};  ///< for `--fault`
  std::vector<Fault> faults{};
};

/// Flies it with processes of its own, to its end or for ten minutes, after which it is killed.
/// Returns the faults that were injected: one whose process had ended by then is left out. Logs
/// them to chaos.jsonl in the run directory.
Result<std::vector<Fault>> fly_disturbed(const ChaosFlightSpec& spec);

}  // namespace swarm::launcher
