// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::planner {

/// Where a robot enters a plan that was made while it moved.
struct PlanEntry {
  static constexpr std::uint16_t kAnywhere = 0xFFFF;
  std::uint16_t source = kAnywhere;  ///< index into FlowPlan::sources()
  std::uint16_t share = 0;           ///< / 65536: its draw at the splits that follow the source

  static std::uint16_t share_of(double share) {
    return static_cast<std::uint16_t>(share * 65536.0);
  }
  /// In [0, 1).
  double draw_share() const { return share / 65536.0; }
};

}  // namespace swarm::planner
