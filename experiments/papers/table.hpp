// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

inline constexpr std::array<std::string_view, 6> kTables{"swarmprm",  "rover",          "crops",
                                                         "diffusion", "diffusion_fine", "network"};

/// Options of the command line.
struct TableOptions {
  std::string which;   ///< one of kTables
  bool quick = false;  ///< fewer robots and seeds, to see that it works
  std::filesystem::path missions = "deploy/missions";
  std::filesystem::path
      out;  ///< directory for the table (Markdown, JSON) and pictures; empty: none
};

/// `swarm_launcher table`: a paper's experiment, simulated, with the paper's and its peers' figures
/// beside ours. The table goes to stdout as Markdown, progress to stderr. What the papers' metres
/// and minutes can be compared to is given by docs/BENCHMARKS.md: their obstacles are not
/// published.
Result<ExitCode> make_table(const TableOptions& options);

}  // namespace swarm::launcher
