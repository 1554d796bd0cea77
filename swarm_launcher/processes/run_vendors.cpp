// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/run_vendors.hpp"

#include <fmt/format.h>

namespace swarm::launcher {

Result<void> apply_vendor(std::string_view text, RunVendors& vendors) {
  const std::size_t equals = text.find('=');
  const bool has_role = equals != std::string_view::npos;
  const auto vendor = link::vendor_named(has_role ? text.substr(equals + 1) : text);
  if (!vendor) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: the vendors are fastdds and cyclonedds", text));
  }
  if (!has_role) {
    vendors = {.launcher = *vendor, .planner = *vendor, .agents = *vendor};
    return {};
  }
  const std::string_view role = text.substr(0, equals);
  if (role == "launcher") {
    vendors.launcher = *vendor;
  } else if (role == "planner") {
    vendors.planner = *vendor;
  } else if (role == "agents") {
    vendors.agents = *vendor;
  } else {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: the roles are launcher, planner and agents", text));
  }
  return {};
}

}  // namespace swarm::launcher
