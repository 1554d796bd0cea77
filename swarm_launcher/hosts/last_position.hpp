// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "swarm_launcher/supervision/fallen_body.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::launcher {

/// Where a robot made its last step. A joined host sends it to the launcher when the robot's
/// process has ended or makes no steps.
struct LastPosition {
  RobotId robot;
  LastKnown known;  ///< with a command
};

/// From the end of a robot's log in a run directory. Empty if there is no log or no step in it.
/// Reads the last minute of the log, or all of it if that is empty. Takes milliseconds.
std::optional<LastKnown> last_known_in_log(const std::filesystem::path& run_dir, RobotId robot,
                                           const Mission& mission);

/// A line of the protocol between host and launcher: {"last": robot, "utc_ns": …, "position_m":
/// [x, y], "command_mps": [x, y], "speed_mps": v or null, "final": true or false}.
std::string to_line(const LastPosition& last);
/// Empty if fields are missing, of another type, or beyond what a run can have.
std::optional<LastPosition> parse_last_position(const nlohmann::json& line);

}  // namespace swarm::launcher
