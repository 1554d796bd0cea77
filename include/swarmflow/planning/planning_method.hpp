// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/planning/measured_swarm.hpp"
#include "swarmflow/planning/plan_request.hpp"
#include "swarmflow/planning/plan_result.hpp"

namespace swarm::planner {

/// What a method guarantees to keep the risk limit CVaR_α ≤ δ (RiskLimit).
enum class RiskPromise {
  kNone,           ///< no guarantee
  kEveryGaussian,  ///< every Gaussian of the plan, all along its legs
  kMixture,        ///< the mixture as a whole, at the times of the plan's nodes
};

/// Properties of a method. The planner program, audits and reports read them, so that none of them
/// depends on the method's name.
struct PlanningTraits {
  RiskPromise risk_promise = RiskPromise::kNone;  ///< what keeps the risk limit
  /// Whether robots are to be where the plan has them when it has them there: then its density and
  /// speed are checked against what their bodies can do. False where the plan is only a guide.
  bool is_kept_in_time = false;
  double speed_mps = 0.0;  ///< speed of the means along their routes; 0: not constant [m/s]
  std::optional<double> density_cap_per_m2{};  ///< cap that every plan keeps, if any [robots/m²]
  bool uses_positions = false;  ///< whether ReportedRobot::leg and ReportedRobot::goal are needed
};

/// Plans the flow of a swarm: the extension point of `planner.method` (planning_registry.hpp). One
/// object serves a whole mission.
///
/// All calls come from one thread, the planner program's only one. A method may keep data between
/// calls (a roadmap of a map that hardly changes); the same sequence of calls with the same random
/// states must give the same plans. Memory may be allocated freely. No call may throw: an exception
/// ends the planner program with exit code 2, after which the launcher restarts it.
///
/// The first plan of a mission is one call of plan(). A plan for a swarm under way is the sequence
///
///   measure(swarm)                          groups: the start mixture
///   goal_from(swarm)                        the goal mixture
///   plan({world, start, goal}, context)
///   order_members(groups, plan, swarm)      which robot takes which route
class PlanningMethod {
 public:
  /// Methods are owned through this class.
  virtual ~PlanningMethod() = default;
  PlanningMethod(const PlanningMethod&) = delete;
  PlanningMethod& operator=(const PlanningMethod&) = delete;

  /// Plans the flow from request.start to request.goal.
  ///
  /// Heartbeats go on meanwhile, from a thread of their own: robots follow their last plan.
  /// \param request start, goal and map
  /// \param context random generator and clock
  /// \return kInfeasible where there is no such flow; the message states why, and which key of the
  ///   mission to change. The last plan then stays in force.
  virtual Result<PlanResult> plan(const PlanRequest& request, const PlanContext& context) = 0;

  /// The risk limit of the next plan: that of the mission until set_risk() is called. A method
  /// without a guarantee only stores it.
  virtual const RiskLimit& risk() const = 0;
  /// Sets the risk limit of plans from now on; an operator may change it during a mission (`risk`).
  virtual void set_risk(const RiskLimit& risk) = 0;

  /// Properties of the method; constant during its lifetime. By default a guide without guarantees.
  virtual PlanningTraits traits() const { return {}; }

  /// Period after which a running mission gets a new plan although nothing changed, until all
  /// robots have arrived; empty (the default) for a method whose plan holds for the whole mission.
  virtual std::optional<Duration> replan_period() const { return std::nullopt; }

  /// Divides the robots into groups, each robot into exactly one: group i becomes source i of the
  /// plan, and robots are sent their group and their share in it. The default clusters robots
  /// within 6 m and in line of sight of each other, fits Gaussians that keep risk(), and keeps
  /// robots that have arrived in their goal component.
  /// \param swarm the robots, the map and the goal
  /// \return kInfeasible where robots are too near an obstacle for any Gaussian that keeps the
  ///   risk limit
  virtual Result<std::vector<RobotGroup>> measure(const MeasuredSwarm& swarm);

  /// The goal to plan to from measured groups, by default swarm.goal. An override returns the same
  /// components with other weights, for methods that assign whole robots.
  virtual Mixture goal_from(const MeasuredSwarm& swarm) const { return swarm.goal; }

  /// Reorders RobotGroup::members once the plan is known, which decides who takes which route at
  /// the splits. Group i is source i of the plan. By default the order of measure() stays.
  virtual void order_members(std::vector<RobotGroup>& /*groups*/, const FlowPlan& /*plan*/,
                             const MeasuredSwarm& /*swarm*/) const {}

  /// Called when a tenth of the robots has made no progress for 8 s.
  /// The argument is the position of one of them [m].
  /// \return whether the method's next plan avoids that position; then it is made at once
  virtual bool on_congestion(const Vec2& /*at_m*/) { return false; }

 protected:
  /// Only for derived classes.
  PlanningMethod() = default;
};

}  // namespace swarm::planner
