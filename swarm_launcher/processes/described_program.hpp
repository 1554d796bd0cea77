// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>

#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/catalogue.hpp"

namespace swarm::launcher {

/// The components of a robot or planner program: runs `program --describe` and reads the JSON that
/// it prints. kBadInput if it cannot be started, does not end within the time, which is far longer
/// than printing tables takes, or prints something else.
Result<Catalogue> describe_program(const std::filesystem::path& program,
                                   Duration timeout = std::chrono::seconds(10));

/// The components that a mission may name when these programs are going to fly it; an empty path
/// stands for our own program.
Result<Catalogue> catalogue_of(const std::filesystem::path& agent_program,
                               const std::filesystem::path& planner_program);

}  // namespace swarm::launcher
