// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_link/roles/join.hpp"

namespace swarm::link {

/// The meeting of a run, from the file in its run directory. Discovery server and relay
/// participants exclude each other: `relays` is 0 in a run with a server. `faults`: simulated for
/// the process that joins, not part of the file.
inline Meeting meeting_of(const shell::RunInfo& run, ReceptionFaults faults = {}) {
  return {.domain = run.domain,
          .server = {run.discovery_host, run.discovery_port},
          .relays = run.relays,
          .launcher = run.launcher,
          .planner = run.planner,
          .host = run.host,
          .interface = run.interface,
          .faults = std::move(faults)};
}

}  // namespace swarm::link
