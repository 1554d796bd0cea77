// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "swarm_monitor/audit/tracking/tracking.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::monitor {

/// One line for each bar of the mission that the run misses, with value and bar; and one for each
/// whose quantity could not be measured, with the reason: no evidence is no pass. What rests on the
/// robots' own references counts only while those are the plan's (Tracking::no_references).
std::vector<std::string> failed_criteria(const CriteriaSpec& criteria, const Tracking& tracking,
                                         std::optional<double> path_ratio);

}  // namespace swarm::monitor
