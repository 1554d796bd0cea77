// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/catalogue.hpp"

namespace swarm::launcher {

/// A robot program's description of itself: runs `program --describe` and reads the JSON that it
/// prints. kBadInput if it cannot be started, does not end within ten seconds, or prints something
/// else.
Result<Catalogue> describe_program(const std::filesystem::path& program);

/// The components that a mission may name when this program is going to fly its robots and our own
/// plans; an empty path stands for our own program.
Result<Catalogue> catalogue_of(const std::filesystem::path& agent_program);

}  // namespace swarm::launcher
