// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "swarm_core/base/result.hpp"
#include "swarm_core/mission/phase.hpp"

namespace swarm::launcher {

/// `swarm_launcher command RUN_DIR start|pause|resume|stop`: tells a running mission, prints its
/// answer. Exit 1 when a stop was not confirmed by every robot.
Result<ExitCode> command_mission(const std::filesystem::path& run_dir, CommandKind kind);

}  // namespace swarm::launcher
