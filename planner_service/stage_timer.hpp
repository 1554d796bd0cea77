// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "swarmflow/planning/plan_request.hpp"

namespace swarm::planner {

/// Takes the time between calls. \pre the clock outlives it
class StageTimer {
 public:
  explicit StageTimer(const StageClock& clock) : clock_(clock), last_(clock()) {}
  double lap_ms() {
    const SteadyTime now = clock_();
    const double lap_ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return lap_ms;
  }

 private:
  const StageClock& clock_;
  SteadyTime last_;
};

}  // namespace swarm::planner
