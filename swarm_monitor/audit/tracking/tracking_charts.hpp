// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "swarm_monitor/audit/tracking/tracking.hpp"

namespace swarm::monitor {

/// Figures of the report: W2 and its floor, the robots' lags, flown and planned density, each over
/// time. Nothing of what was not measured.
std::string tracking_figures(const Tracking& tracking);

}  // namespace swarm::monitor
