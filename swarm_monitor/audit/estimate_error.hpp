// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "swarm_monitor/audit/recorded_run.hpp"

namespace swarm::monitor {

/// Quantiles of the distance between the estimated and the true positions of neighbours, over all
/// logged estimates.
struct EstimateError {
  double p50_cm = 0.0, p99_cm = 0.0, p999_cm = 0.0, max_cm = 0.0;
};

/// Compares every logged estimate with the track of the estimated robot at the same time. Tracks
/// are by robot id. Estimates at times at which that robot has no track are left out; empty if all
/// are. O(estimates · log steps).
std::optional<EstimateError> estimate_error(std::span<const Track> tracks);

}  // namespace swarm::monitor
