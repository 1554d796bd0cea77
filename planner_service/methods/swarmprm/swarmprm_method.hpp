// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "planner_service/methods/swarmprm/swarmprm_options.hpp"
#include "planner_service/roadmap/live_roadmap.hpp"
#include "swarmflow/planning/planning_method.hpp"
#include "swarmflow/planning/planning_registry.hpp"

namespace swarm::planner {

/// SwarmPRM as a planning method. It keeps its roadmap and repairs it when obstacles or ends
/// change.
class SwarmPrmMethod final : public PlanningMethod {
 public:
  explicit SwarmPrmMethod(const SwarmPrmOptions& options) : options_(options) {}
  static Result<std::unique_ptr<PlanningMethod>> make(const MethodContext& context);
  static const std::vector<OptionSpec>& keys();  ///< of the mission's planner section

  Result<PlanResult> plan(const PlanRequest& request, const PlanContext& context) override;
  const RiskLimit& risk() const override { return options_.risk; }
  void set_risk(const RiskLimit& risk) override;
  PlanningTraits traits() const override;

 private:
  Roadmap roadmap_for(const PlanRequest& request, Rng& rng);

  SwarmPrmOptions options_;
  std::optional<LiveRoadmap> live_;
};

}  // namespace swarm::planner
