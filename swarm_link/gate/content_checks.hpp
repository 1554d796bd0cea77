// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/scene.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarm_link/gate/refusal.hpp"
#include "swarm_link/gate/wire_limits.hpp"
#include "swarm_link/messages.hpp"

/// What one message must satisfy by itself: schema, sizes, finite numbers, ranges. Pure functions.
/// What it must satisfy next to the messages before it and to our clock is the Gate's: a receiver
/// asks the Gate, never these alone.
namespace swarm::link {

/// PlanEntryMessage::source of a robot that may enter where it likes.
inline constexpr std::uint16_t kAnySource = 0xFFFF;

/// FlowPlan::make decides on Gaussians and masses; means must lie inside the bounds plus slack, and
/// robots must enter at sources of the plan.
Checked<FlowPlan> check_plan(const PlanMessage& message, const WireLimits& limits);

/// Shapes must be valid, obstacles in order, vertices all used, bodies those of robots of the
/// mission.
Checked<Scene> check_scene(const SceneMessage& message, const WireLimits& limits);

Checked<void> check_heartbeat(const HeartbeatMessage& message);
Checked<void> check_command(const CommandMessage& message);
Checked<void> check_status(const StatusMessage& message, const WireLimits& limits);
Checked<void> check_event(const EventMessage& message, const WireLimits& limits);

/// Schema and number of states of a batch. Its states are checked one by one.
Checked<void> check_batch(const CellStatesMessage& message);

/// Also that its stamp is within clock_skew_refuse of `now`: a state is of use only while it is
/// fresh. For callers that deliver states without a bus, such as a simulated network, this is the
/// whole check. Does not allocate.
Checked<void> check_state(const RobotStateMessage& state, const WireLimits& limits, UtcTime now);

}  // namespace swarm::link
