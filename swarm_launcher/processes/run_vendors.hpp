// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "swarm_core/mission/vendor.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// DDS implementation of each role in a run.
struct RunVendors {
  link::Vendor launcher = link::Vendor::kFastDds;
  link::Vendor planner = link::Vendor::kFastDds;
  link::Vendor agents = link::Vendor::kFastDds;

  /// Whether any role uses a vendor.
  bool any(link::Vendor vendor) const {
    return launcher == vendor || planner == vendor || agents == vendor;
  }
  bool operator==(const RunVendors&) const = default;
};

/// Applies one `[ROLE=]VENDOR`: ROLE is launcher, planner or agents; without a role it is for all
/// three. Unknown names change nothing.
Result<void> apply_vendor(std::string_view text, RunVendors& vendors);

}  // namespace swarm::launcher
