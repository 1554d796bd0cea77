// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "swarm_core/mission/channel.hpp"
#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/mission/mission.hpp"

/// Text messages of PROTOCOL.md.
namespace swarm::monitor {

/// Input of a scene message.
struct SceneFacts {
  const Mission& mission;
  const World& world;  ///< with obstacles where they are at the scene's time
  const Mixture& goal;
  const FlowPlan* plan = nullptr;
  double plan_excess_m = 0.0;  ///< largest constraint violation of the plans so far
  double from_s = 0.0;         ///< time from which the scene holds, since the begin
  double end_s = 0.0;          ///< length of a recording; 0 while the run is in progress
  bool live = false;
  bool control = false;                ///< the page offers to control the run
  Channel channel = Channel::kGroups;  ///< chooses the size of the cells to draw
};
std::string scene_json(const SceneFacts& facts);

std::string event_json(const RunEvent& event);

/// One row of the series; numbers that are not finite are null.
struct SeriesRow {
  double time_s = 0.0;
  double nearest_gap_m = 0.0;
  std::uint32_t arrived = 0, moving = 0;
  double latency_ms = 0.0, rate_hz = 0.0;
};
std::string series_json(const SeriesRow& row);

}  // namespace swarm::monitor
