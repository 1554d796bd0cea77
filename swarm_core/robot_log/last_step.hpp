// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::robot_log {

/// Code of the launcher's event about the last step of a robot whose process was killed or is
/// frozen: its log may lack the last records, which the process had not handed to the disk.
inline constexpr std::string_view kLastStepCode = "last-step";

/// What that event reports.
struct LastStep {
  RobotId robot;
  UtcTime stamp{};
  Vec2 position_m = Vec2::Zero();
  Vec2 velocity_mps = Vec2::Zero();  ///< commanded
};

/// The text of the event.
std::string to_text(const LastStep& step);
/// From that text; empty for any other.
std::optional<LastStep> parse_last_step(std::string_view text);

}  // namespace swarm::robot_log
