// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// `swarm_launcher command RUN_DIR COMMAND [KEYS]`: sends a command to a running mission and prints
/// the answer. COMMAND is start, pause, resume or stop, or a change of the scene with its keys as
/// in a script, such as `add_obstacle circle_m: {center: [60, 40], radius: 3}`, or `clear 7`. Exit
/// code 1 when it was refused, or when a stop was not confirmed by every robot.
Result<ExitCode> command_mission(const std::filesystem::path& run_dir, const std::string& line);

}  // namespace swarm::launcher
