// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "swarmflow/core/box.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::link {

/// Ranges of a mission that its messages must keep.
struct WireLimits {
  std::uint32_t robots = 0;  ///< ids are below this
  Box bounds_m;              ///< positions lie inside, plus `bounds_slack_m`
  double bounds_slack_m = 5.0;
  double speed_max_mps = 1.5;    ///< speeds are at most twice this
  Duration clock_skew_warn{};    ///< a stamp further from our clock is used and reported
  Duration clock_skew_refuse{};  ///< a stamp further from our clock is refused
  Duration planner_takeover{};   ///< silence of a planner after which another one is followed
  Duration status_takeover{};    ///< silence of a robot after which another sender is followed
};

/// Limits of a mission; the slack of the bounds is the default.
WireLimits wire_limits(const Mission& mission);

}  // namespace swarm::link
