// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "robot_agent/inbox.hpp"
#include "robot_agent/program/process_options.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_link/channels/state_channel.hpp"
#include "swarm_link/channels/stop_channel.hpp"
#include "swarm_link/port.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::agent {

/// The endpoints of an agent process on the bus.
struct BusAccess {
  std::unique_ptr<link::Participant> participant;  // first: it outlives its endpoints
  std::unique_ptr<link::StateChannel> states;
  std::unique_ptr<link::StopReceiver> stops;  // null: the interface carries no multicast
  Readers readers;
  link::WriterPtr<link::StatusMessage> status;
  link::WriterPtr<link::EventMessage> event;
  std::uint64_t run = 0;  // whose launcher's beats count: its begin [ns]
};

/// Joins the run's bus as the process that the options describe. Fails when the bus cannot be
/// joined.
Result<BusAccess> join_bus(const ProcessOptions& options, const shell::RunInfo& run,
                           const Mission& mission);

/// Makes all endpoints of a participant but those for states, which are left empty.
Result<BusAccess> open_endpoints(std::unique_ptr<link::Participant> participant);

/// Robot states by cell topics of the participant that is in the access already.
void open_topic_channel(BusAccess& access, const LinkSpec& spec);

}  // namespace swarm::agent
