// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "swarm_link/gate/refusal.hpp"
#include "swarm_link/messages.hpp"
#include "swarmflow/mission/mission.hpp"

/// The receiving sides of the five programs behind one interface: a test publishes to them and
/// reads their state and what they refused. No bus, no clock.
namespace swarm::link::conformance {

using AnyMessage = std::variant<PlanMessage, SceneMessage, HeartbeatMessage, CommandMessage,
                                StatusMessage, EventMessage, CellStatesMessage>;

class Receiver {
 public:
  virtual ~Receiver() = default;
  /// Whether the program has a reader of the message's topic.
  virtual bool reads(const AnyMessage& message) const = 0;
  /// Hands a message over and lets the program take it. False when the message cannot be put into
  /// bytes.
  virtual bool publish(const AnyMessage& message, UtcTime now) = 0;
  /// All that the program knows from the bus, as text.
  virtual std::string state() = 0;
  virtual const RefusalCounters& refused() const = 0;
};

/// The robot of the agent's process.
inline constexpr std::uint32_t kOwnRobot = 0;

std::unique_ptr<Receiver> make_agent(const Mission& mission);
std::unique_ptr<Receiver> make_planner(const Mission& mission);
std::unique_ptr<Receiver> make_launcher(const Mission& mission);
std::unique_ptr<Receiver> make_monitor(const Mission& mission);
std::unique_ptr<Receiver> make_gateway_receiver(const Mission& mission);

}  // namespace swarm::link::conformance
