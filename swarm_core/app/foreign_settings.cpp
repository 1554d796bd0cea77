// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/foreign_settings.hpp"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "swarm_core/base/foreign_settings.hpp"

namespace swarm::shell {
namespace {

std::vector<std::string>& dropped() {
  static std::vector<std::string> names;
  return names;
}

}  // namespace

void drop_foreign_settings() {
  dropped() = foreign_settings();
  ignore_foreign_settings();
}

std::optional<std::string> dropped_settings_notice() {
  if (dropped().empty()) return std::nullopt;
  return fmt::format(
      "settings of other DDS and ROS programs have no effect on the bus of a run: {}; the driver "
      "ros2 and `swarm_monitor ros` follow those of ROS",
      fmt::join(dropped(), ", "));
}

}  // namespace swarm::shell
