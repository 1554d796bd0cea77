// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include <fmt/format.h>

#include "swarm_core/app/run_directory.hpp"

namespace swarm::planner {

/// Where a run directory keeps a plan that was made in flight.
inline std::filesystem::path plan_file(const std::filesystem::path& run_dir,
                                       std::uint32_t version) {
  return run_dir / fmt::format("plan-{:04}.json", version);
}

/// The plan that is removed when this one is written; 0: none. The first one always stays.
constexpr std::uint32_t outdated_plan(std::uint32_t version) {
  return version > shell::kPlansKept + 1 ? version - shell::kPlansKept : 0;
}

}  // namespace swarm::planner
