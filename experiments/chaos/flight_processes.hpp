// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <sys/types.h>

/// The processes of a flight, by the kernel's lists of the children of its parents.
namespace swarm::launcher {

/// Those that start the others.
struct FlightParents {
  pid_t launcher = 0;
  pid_t joined = 0;  ///< `join` of the second host; 0: there is none
};

/// The planner; empty while there is none.
std::optional<pid_t> planner_of(const FlightParents& parents);

/// The gateway; empty while there is none.
std::optional<pid_t> gateway_of(const FlightParents& parents);

/// The process that flies this robot, on any host; empty while there is none.
std::optional<pid_t> agent_of(const FlightParents& parents, std::uint32_t robot);

/// SIGKILL to all, also to those that are frozen.
void kill_all(const FlightParents& parents);

}  // namespace swarm::launcher
