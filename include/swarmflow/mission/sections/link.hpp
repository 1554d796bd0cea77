// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "swarmflow/mission/options.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {

/// Key `link`: which states are received, and when they are published.
struct LinkSpec {
  double cell_size_m = 100.0;           ///< side of a cell of the topics channel [m]
  double communication_radius_m = 4.0;  ///< states of robots this near are received [m]
  double join_margin_m = 6.0;           ///< beyond the communication radius: cells to join [m]
  double leave_margin_m = 9.0;          ///< beyond the communication radius: cells to leave [m]
  double group_cell_size_m = 5.0;       ///< side of a cell of the groups channel [m]
  double send_error_m = 0.05;           ///< a state is published when extrapolation is off by this
  double send_interval_max_s = 0.5;     ///< a state is published when the last one is this old
  double send_near_m =
      1.0;                 ///< on a degraded link states are published while a surface is this near
  double status_hz = 1.0;  ///< rate of a robot's statuses
};

/// Keys of the section.
inline constexpr auto kLinkKeys = std::to_array<SectionKey<LinkSpec>>({
    {"cell_size_m", &LinkSpec::cell_size_m, between(1, 10'000), "cell size of the topics channel"},
    {"communication_radius_m", &LinkSpec::communication_radius_m, positive(10'000),
     "states of robots this near are received"},
    {"join_margin_m", &LinkSpec::join_margin_m, between(0, 1000),
     "a cell is joined when it is within the communication radius plus this"},
    {"leave_margin_m", &LinkSpec::leave_margin_m, between(0, 1000),
     "a cell is left when it is farther than the communication radius plus this"},
    {"group_cell_size_m", &LinkSpec::group_cell_size_m, between(1, 10'000),
     "cell size of the groups channel"},
    {"send_error_m", &LinkSpec::send_error_m, between(0, 100),
     "dead reckoning: a state is sent when its extrapolation is off by this"},
    {"send_interval_max_s", &LinkSpec::send_interval_max_s, positive(60),
     "a state is sent when the last one is this old"},
    {"send_near_m", &LinkSpec::send_near_m, between(0, 10'000),
     "on a degraded link a state is sent at every tick while a surface is this near"},
    {"status_hz", &LinkSpec::status_hz, between(0.01, 100), "status messages per second"},
});

}  // namespace swarm
