// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "swarm_monitor/audit/tracking/tracking.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::monitor {

/// The object `tracking` of an audit; what was not measured is null.
nlohmann::ordered_json tracking_json(const Tracking& tracking);

/// The same in a few lines, each with its end; nothing of what was not measured.
std::string tracking_text(const Tracking& tracking);

}  // namespace swarm::monitor
