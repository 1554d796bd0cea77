// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gate/wire_limits.hpp"

#include <algorithm>

namespace swarm::link {

namespace {

// Three lost in a row are rare on a network that loses one message in five.
constexpr double kBeatsMissed = 3.5;
// By then the launcher has ended a process that is silent.
constexpr double kStatusSilence_s = 10.0;

}  // namespace

WireLimits wire_limits(const Mission& mission) {
  return {
      .robots = mission.robots.count,
      .bounds_m = mission.world.bounds_m(),
      .speed_max_mps = largest_speed_mps(mission.robots),
      .clock_skew_warn = from_seconds(mission.timing.clock_skew_warn_s),
      .clock_skew_refuse = from_seconds(mission.timing.clock_skew_refuse_s),
      .planner_takeover = from_seconds(kBeatsMissed / mission.timing.heartbeat_hz),
      .status_takeover = from_seconds(std::max(kStatusSilence_s, 10.0 / mission.link.status_hz))};
}

}  // namespace swarm::link
