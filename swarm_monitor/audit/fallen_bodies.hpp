// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_monitor/audit/recorded_run.hpp"

namespace swarm::monitor {

/// Lets the bodies of fallen robots lie: a robot whose log ends without "exit" stays at its last
/// point until the end of the run, or until the scene says that its body was cleared. One whose log
/// goes on has been respawned: its body is that of the track, also between its two incarnations.
/// O(robots + scenes · bodies).
void lay_fallen_bodies(RecordedRun& run);

}  // namespace swarm::monitor
