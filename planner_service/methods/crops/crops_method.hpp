// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "planner_service/flow/route.hpp"
#include "planner_service/methods/crops/crops_guide.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/planning/planning_method.hpp"
#include "swarmflow/planning/planning_registry.hpp"

namespace swarm::planner {

/// The options of CRoPS in a mission.
CropsOptions crops_options(const Mission& mission);

/// The guide of CRoPS as a planning method. It keeps its graph while the map is the same, and with
/// it the edges that became costly where robots were stuck.
class CropsMethod final : public PlanningMethod {
 public:
  CropsMethod(const CropsOptions& options, const RiskLimit& risk, const LegSpeed& speed);
  static Result<std::unique_ptr<PlanningMethod>> make(const MethodContext& context);
  static const std::vector<OptionSpec>& keys();  ///< of the mission's planner section

  Result<PlanResult> plan(const PlanRequest& request, const PlanContext& context) override;
  const RiskLimit& risk() const override { return risk_; }
  void set_risk(const RiskLimit& risk) override;
  PlanningTraits traits() const override {
    return {.risk_promise = RiskPromise::kEveryGaussian, .speed_mps = speed_.means_mps};
  }
  /// Searches the route nearest to the congestion again with costlier edges.
  bool on_congestion(const Vec2& at_m) override;

 private:
  Result<void> prepare(const PlanRequest& request, Rng& rng);

  CropsOptions options_;
  RiskLimit risk_;
  LegSpeed speed_;
  World world_;  // that guide_ refers to
  std::optional<CropsGuide> guide_;
};

}  // namespace swarm::planner
