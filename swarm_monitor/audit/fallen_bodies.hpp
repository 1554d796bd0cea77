// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_monitor/audit/recorded_run.hpp"

namespace swarm::monitor {

/// Sets Track::body_until_s of dead robots: a robot whose log ends without "exit" stays at its
/// last point until the end of the run, or until a scene records that its body was cleared. The
/// last step of a killed robot, which its log may lack, is taken from the launcher's event
/// `last-step`. A robot whose log continues has been respawned: its body is the track itself, also
/// between two incarnations. Where the last point is outside of the circle of a scene, the log
/// lacks its end, which is counted, and there is no body. O(robots + scenes · bodies + events²) for
/// few events.
void lay_fallen_bodies(RecordedRun& run);

}  // namespace swarm::monitor
