// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// `command RUN_DIR stop`: asks the launcher, and at the same time sends the stop to the robots, so
/// that a launcher that hangs or is gone does not matter. Prints the launcher's answer, or who has
/// confirmed if there is none. kCriteriaNotMet if a robot has not.
Result<ExitCode> stop_run(const std::filesystem::path& run_dir);

/// `command --domain N stop`: stops all robots of a DDS domain without a run directory.
Result<ExitCode> stop_domain(std::uint32_t domain, const std::string& interface);

}  // namespace swarm::launcher
