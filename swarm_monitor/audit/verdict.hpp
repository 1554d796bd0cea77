// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "swarm_monitor/audit/audit.hpp"

namespace swarm::monitor {

/// Why a run fails, one line each, in this order: missing evidence, robots lost or not arrived,
/// contacts, robots outside of the world, criteria of the mission, goals with too few or too many
/// robots. Empty if the outcome is "ok". Long lists of robots are cut after ten. Reads all of the
/// audit but `reasons`.
std::vector<std::string> reasons_for_failure(const AuditedRun& audited);

}  // namespace swarm::monitor
