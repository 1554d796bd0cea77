// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "swarm_monitor/audit/recorded_run.hpp"

namespace swarm::monitor {

/// Quantiles of how far from the truth robots took their neighbours to be.
struct EstimateError {
  double p50_cm = 0.0, p99_cm = 0.0, p999_cm = 0.0, max_cm = 0.0;
};

/// Every belief on record against the track of the robot it is about, at its time. Tracks are by
/// robot id. Beliefs about times in which that robot has no track are left out; empty if all are.
std::optional<EstimateError> estimate_error(std::span<const Track> tracks);

}  // namespace swarm::monitor
