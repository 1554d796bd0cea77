// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

struct PlanCommandOptions {
  std::filesystem::path mission_file;
  std::uint64_t seed = 1;
  std::uint32_t repeat = 1;   ///< seeds seed … seed + repeat − 1
  std::filesystem::path out;  ///< directory for plan.json and plan.svg; empty: none
  bool json = false;
  bool times = false;  ///< also print when the groups of the first plan pass its narrowest place
};

/// `swarm_launcher plan`: plans without flying; prints times as medians, ratios as means, the
/// largest CVaR and the share of seeds that succeeded.
Result<ExitCode> plan_mission(const PlanCommandOptions& options);

}  // namespace swarm::launcher
