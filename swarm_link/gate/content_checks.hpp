// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "swarm_link/gate/refusal.hpp"
#include "swarm_link/gate/wire_limits.hpp"
#include "swarm_link/messages.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/scene.hpp"

/// Checks of one message by itself: schema, sizes, finite numbers, ranges. Pure functions. The Gate
/// also compares a message with those before it and with the clock; receivers therefore call the
/// Gate, not these functions.
namespace swarm::link {

/// PlanEntryMessage::source of a robot that may enter the plan at any source.
inline constexpr std::uint16_t kAnySource = 0xFFFF;

/// Largest plan time: twelve days. A larger one is an invented number.
inline constexpr double kMaxPlanTime_s = 1e6;

/// FlowPlan::make checks Gaussians and masses; their axes may differ by 10⁵ at most. Means must lie
/// inside the bounds plus slack, and robots must enter at sources of the plan.
Checked<FlowPlan> check_plan(const PlanMessage& message, const WireLimits& limits);

/// Shapes must be valid, obstacle ids ascending, all vertices used, and bodies those of robots of
/// the mission.
Checked<Scene> check_scene(const SceneMessage& message, const WireLimits& limits);

/// Plan rate in [0, 1], finite times, a known phase.
Checked<void> check_heartbeat(const HeartbeatMessage& message);
/// A known kind of command.
Checked<void> check_command(const CommandMessage& message);
/// Robots of the mission inside the bounds, bins that exist.
Checked<void> check_status(const StatusMessage& message, const WireLimits& limits);
/// A known source and severity, and printable texts (printable.hpp).
Checked<void> check_event(const EventMessage& message, const WireLimits& limits);

/// Schema and number of states of a batch. Its states are checked one by one.
Checked<void> check_batch(const CellStatesMessage& message);

/// Ids, ranges and speed, and a stamp within clock_skew_refuse of `now`, since only a recent state
/// is useful. Callers that deliver states without a bus, such as the simulated network, need no
/// other check. Does not allocate.
Checked<void> check_state(const RobotStateMessage& state, const WireLimits& limits, UtcTime now);

}  // namespace swarm::link
