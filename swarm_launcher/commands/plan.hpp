// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Options of `swarm_launcher plan`.
struct PlanCommandOptions {
  std::filesystem::path mission_file;
  std::uint64_t seed = 1;     ///< the first one
  std::uint32_t repeat = 1;   ///< seeds seed … seed + repeat − 1
  std::filesystem::path out;  ///< directory for plan.json and plan.svg; empty: none
  bool json = false;          ///< print JSON instead of text
  bool times = false;         ///< also print when each group passes the narrowest passage
};

/// `swarm_launcher plan`: plans a mission for one or more seeds without flying it. Prints times as
/// medians, ratios as means, the largest CVaR and the share of seeds that succeeded.
Result<ExitCode> plan_mission(const PlanCommandOptions& options);

}  // namespace swarm::launcher
