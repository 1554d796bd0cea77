// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "swarmPubSubTypes.h"
#include "swarm_link/messages.hpp"

/// Between our messages and the generated wire types.
namespace swarm::link::fastdds {

/// Generated type and type support of a message.
template <class M>
struct WireOf;
template <>
struct WireOf<PlanMessage> {
  using Type = wire::FlowPlan;
  using Support = wire::FlowPlanPubSubType;
};
template <>
struct WireOf<SceneMessage> {
  using Type = wire::Scene;
  using Support = wire::ScenePubSubType;
};
template <>
struct WireOf<HeartbeatMessage> {
  using Type = wire::Heartbeat;
  using Support = wire::HeartbeatPubSubType;
};
template <>
struct WireOf<CellStatesMessage> {
  using Type = wire::CellStates;
  using Support = wire::CellStatesPubSubType;
};
template <>
struct WireOf<CommandMessage> {
  using Type = wire::Command;
  using Support = wire::CommandPubSubType;
};
template <>
struct WireOf<StatusMessage> {
  using Type = wire::Status;
  using Support = wire::StatusPubSubType;
};
template <>
struct WireOf<EventMessage> {
  using Type = wire::Event;
  using Support = wire::EventPubSubType;
};

/// False when a sequence is longer than the contract allows; `out` is unspecified then. Over-long
/// strings are cut.
bool to_wire(const PlanMessage& in, wire::FlowPlan& out);
bool to_wire(const SceneMessage& in, wire::Scene& out);
bool to_wire(const HeartbeatMessage& in, wire::Heartbeat& out);
bool to_wire(const CellStatesMessage& in, wire::CellStates& out);
bool to_wire(const CommandMessage& in, wire::Command& out);
bool to_wire(const StatusMessage& in, wire::Status& out);
bool to_wire(const EventMessage& in, wire::Event& out);

/// Takes everything over as it came; the edge judges it.
void from_wire(const wire::FlowPlan& in, PlanMessage& out);
void from_wire(const wire::Scene& in, SceneMessage& out);
void from_wire(const wire::Heartbeat& in, HeartbeatMessage& out);
void from_wire(const wire::CellStates& in, CellStatesMessage& out);
void from_wire(const wire::Command& in, CommandMessage& out);
void from_wire(const wire::Status& in, StatusMessage& out);
void from_wire(const wire::Event& in, EventMessage& out);

}  // namespace swarm::link::fastdds
