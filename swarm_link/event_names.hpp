// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "swarm_link/messages.hpp"

/// Names of severities and event sources in files and messages.
namespace swarm::link {

/// Lower case, as in the event log. "unknown" for a value that is not of the enumeration, which a
/// message may contain before it is checked.
constexpr std::string_view to_string(Severity severity) {
  switch (severity) {
    case Severity::kInfo:
      return "info";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      return "error";
  }
  return "unknown";
}

/// Code of the event by which a robot reports states under its id that it did not publish.
inline constexpr std::string_view kDuplicateId = "duplicate-id";

/// Code of the event by which a robot reports that it cannot receive all cells around.
inline constexpr std::string_view kCellsMissing = "cells-missing";

/// "planner", "launcher" or "robot-7".
inline std::string source_name(std::uint32_t source) {
  if (source == kPlannerSource) return "planner";
  if (source == kLauncherSource) return "launcher";
  return "robot-" + std::to_string(source);
}

}  // namespace swarm::link
