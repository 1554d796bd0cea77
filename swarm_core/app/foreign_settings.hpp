// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace swarm::shell {

/// Removes the settings of other DDS and ROS programs from the environment and keeps their names.
/// run_main() does it first, while the process has one thread. A child inherits the cleaned
/// environment, so it has nothing left to name.
void drop_foreign_settings();

/// What the user should know of the dropped settings, in one line; empty if there were none.
std::optional<std::string> dropped_settings_notice();

}  // namespace swarm::shell
