// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "swarm_monitor/audit/recorded_run.hpp"

namespace swarm::monitor {

/// What a run should have left behind and did not, a sentence each: gaps in robot logs or in a
/// recording, changes of the scene that robots took and its log lacks, plans that the clock or
/// robots name, and what its processes reported as lost. Empty if the records are complete; a
/// verdict on incomplete ones is never "ok".
std::vector<std::string> missing_evidence(const RecordedRun& run);

}  // namespace swarm::monitor
