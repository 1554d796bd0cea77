// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "robot_agent/methods/shared/density_attraction.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/robot/planned_density.hpp"

namespace swarm::agent {

/// The swarm's planned density at the plan's time, for missions whose control method reads it;
/// one for all robots of a process. No allocation once warm.
class DensityForecast {
 public:
  DensityForecast(const Mission& mission, bool is_asked_for)
      : is_asked_for_(is_asked_for), robots_(mission.robots.count) {}

  bool is_asked_for() const { return is_asked_for_; }

  /// Evaluates the plan's mixture at this plan time [s]. \pre is_asked_for() and the plan is not
  /// empty
  void update(const FlowPlan& plan, double plan_time_s) {
    agent::update(density_, plan, plan_time_s, robots_,
                  DensityAttractionOptions{}.kernel_sigma_m());
  }

  /// As of the last update(); null before the first.
  const PlannedDensity* density() const { return density_.parts.empty() ? nullptr : &density_; }

 private:
  bool is_asked_for_;
  std::uint32_t robots_;
  PlannedDensity density_;
};

}  // namespace swarm::agent
