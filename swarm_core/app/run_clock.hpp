// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "swarmflow/core/time.hpp"

/// The clock of a run. Epochs of planners, ids of commands, versions of scenes and all stamps are
/// times of this clock: UTC as the launcher's machine had it when the launcher started, carried on
/// by the steady clock of each machine. Setting a machine's wall clock changes nothing in flight.
namespace swarm::shell {

/// What the processes of one machine need to agree on a clock.
struct RunClock {
  /// Of the machine's last start; another one has another steady clock. Empty: unknown.
  std::string boot_id;
  std::int64_t utc_minus_steady_ns = 0;
};

/// The clock of this process, for the processes that are to follow it.
RunClock own_clock();

/// Makes utc_now() of this process the clock of the run. False, and nothing changes, if the clock
/// is that of another machine or of one that has been restarted since: then utc_now() is this
/// machine's own UTC.
bool follow(const RunClock& clock);

/// For a process on another machine: `theirs` was the time of the run's clock at `then`.
void follow(UtcTime theirs, SteadyTime then);

}  // namespace swarm::shell
