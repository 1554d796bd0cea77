// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "planner_service/flow/route.hpp"
#include "planner_service/methods/adoc/adoc.hpp"
#include "swarmflow/planning/planning_method.hpp"
#include "swarmflow/planning/planning_registry.hpp"

namespace swarm::planner {

/// The options of ADOC in a mission.
AdocOptions adoc_options(const Mission& mission);

/// ADOC as a planning method. It guarantees neither the risk limit nor a density cap.
class AdocMethod final : public PlanningMethod {
 public:
  AdocMethod(const AdocOptions& options, const RiskLimit& risk, const LegSpeed& speed);
  static Result<std::unique_ptr<PlanningMethod>> make(const MethodContext& context);
  static const std::vector<OptionSpec>& keys();  ///< of the mission's planner section

  Result<PlanResult> plan(const PlanRequest& request, const PlanContext& context) override;
  const RiskLimit& risk() const override { return risk_; }
  /// Used for the groups that a plan in flight starts from; ADOC itself does not use it.
  void set_risk(const RiskLimit& risk) override { risk_ = risk; }
  PlanningTraits traits() const override { return {.speed_mps = speed_.means_mps}; }

 private:
  AdocOptions options_;
  RiskLimit risk_;
  LegSpeed speed_;
};

}  // namespace swarm::planner
