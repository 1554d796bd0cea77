// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_launcher/flight/health_inbox.hpp"
#include "swarm_link/port.hpp"

namespace swarm::launcher {

/// The launcher's endpoints on the bus.
struct LauncherBus {
  link::Participant* participant;  ///< made the endpoints and outlives them
  HealthInbox inbox;               ///< what planner and robots report
  link::WriterPtr<link::CommandMessage> commands;
  link::WriterPtr<link::SceneMessage> scenes;
  link::WriterPtr<link::StatusMessage> status_relay;  ///< for monitors
  link::WriterPtr<link::EventMessage> event_relay;    ///< for monitors
};

/// Makes the endpoints. \pre the participant outlives them
Result<LauncherBus> open_launcher_bus(link::Participant& participant,
                                      const link::WireLimits& limits);

}  // namespace swarm::launcher
