// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "planner_service/methods/rover/rover.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/planning/planning_method.hpp"
#include "swarmflow/planning/planning_registry.hpp"

namespace swarm::planner {

/// The options of ROVER in a mission.
RoverOptions rover_options(const Mission& mission);

/// ROVER as a planning method: a plan from where the robots are at each period, in whole robots.
/// It keeps the graph of a map and a goal.
class RoverMethod final : public PlanningMethod {
 public:
  RoverMethod(const RoverOptions& options, Duration replan_period);
  static Result<std::unique_ptr<PlanningMethod>> make(const MethodContext& context);
  static const std::vector<OptionSpec>& keys();  ///< of the mission's planner section

  Result<PlanResult> plan(const PlanRequest& request, const PlanContext& context) override;
  const RiskLimit& risk() const override { return options_.graph.risk; }
  void set_risk(const RiskLimit& risk) override;
  PlanningTraits traits() const override;
  std::optional<Duration> replan_period() const override { return replan_period_; }
  /// The robots of a leg are a group. From the first call on a plan may violate (11g) where the
  /// swarm does so already; such a plan first reduces the violation.
  Result<std::vector<RobotGroup>> measure(const MeasuredSwarm& swarm) override;
  /// Weights as whole numbers of robots.
  Mixture goal_from(const MeasuredSwarm& swarm) const override;
  /// By the assignment of members to routes that moves them least.
  void order_members(std::vector<RobotGroup>& groups, const FlowPlan& plan,
                     const MeasuredSwarm& swarm) const override;

 private:
  Result<Rover*> rover_for(const World& world, const Mixture& goal);

  RoverOptions options_;
  Duration replan_period_;
  World world_;  // that rover_ refers to
  Mixture goal_;
  std::optional<Rover> rover_;
};

}  // namespace swarm::planner
