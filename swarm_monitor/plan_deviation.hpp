// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarm_monitor/recorded_run.hpp"

namespace swarm::monitor {

/// The planned mixture against the robots that were to make it up, once a second from the first
/// step in motion on: both have a centre and a spread, the root of the trace of the covariance [m].
struct PlanDeviation {
  static constexpr double kStep_s = 1.0;
  double begin_s = 0.0;  ///< of the motion
  std::vector<double> centre_off_m;
  std::vector<double> planned_spread_m;
  std::vector<double> real_spread_m;
};

/// Empty without a plan or motion. Of a run that was planned anew, only the first plan counts.
PlanDeviation plan_deviation(const RecordedRun& run);

}  // namespace swarm::monitor
