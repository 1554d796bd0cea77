// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/body_limits.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/planning/plan_request.hpp"
#include "swarmflow/planning/plan_result.hpp"
#include "swarmflow/planning/planning_method.hpp"
#include "swarmflow/planning/planning_registry.hpp"

namespace swarm::planner {

/// The method of a mission, and the steps common to all methods: total time, size of the graph that
/// was searched, and the check whether robots can follow the plan.
class Planner {
 public:
  /// `limits` of zeros: bodies are not known, nothing is checked against them. `robots`: how many.
  Planner(std::unique_ptr<PlanningMethod> method, const SwarmLimits& limits, double robots);

  /// The method that the mission names. Errors as of PlanningRegistry::make().
  static Result<Planner> make(const PlanningRegistry& registry, const Mission& mission,
                              PlanningUse use = PlanningUse::kInFlight);

  /// A plan by the method, with warnings where bodies cannot follow it. Errors are the method's;
  /// kBadInput if its plan has not one source for each start component.
  Result<PlanResult> plan(const PlanRequest& request, const PlanContext& context);

  /// For plans from now on.
  void set_risk(const RiskLimit& risk);

  PlanningMethod& method() { return *method_; }
  const PlanningMethod& method() const { return *method_; }

 private:
  std::unique_ptr<PlanningMethod> method_;
  SwarmLimits limits_;
  double robots_;
};

}  // namespace swarm::planner
