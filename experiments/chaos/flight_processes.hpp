// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <sys/types.h>

/// The processes of a running launcher, by the kernel's list of its children.
namespace swarm::launcher {

/// The planner; empty while there is none.
std::optional<pid_t> planner_of(pid_t launcher);

/// The process that flies this robot; empty while there is none.
std::optional<pid_t> agent_of(pid_t launcher, std::uint32_t robot);

}  // namespace swarm::launcher
