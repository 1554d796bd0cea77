// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm.h"
#include "swarm_link/messages.hpp"

/// Between our messages and the wire types generated from the IDL for Fast CDR.
namespace swarm::link::cdr {

/// Generated type of a message.
template <class M>
struct WireOf;
template <>
struct WireOf<PlanMessage> {
  using Type = wire::FlowPlan;
};
template <>
struct WireOf<SceneMessage> {
  using Type = wire::Scene;
};
template <>
struct WireOf<HeartbeatMessage> {
  using Type = wire::Heartbeat;
};
template <>
struct WireOf<CellStatesMessage> {
  using Type = wire::CellStates;
};
template <>
struct WireOf<CommandMessage> {
  using Type = wire::Command;
};
template <>
struct WireOf<StatusMessage> {
  using Type = wire::Status;
};
template <>
struct WireOf<EventMessage> {
  using Type = wire::Event;
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

}  // namespace swarm::link::cdr
