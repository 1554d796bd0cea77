// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "swarmflow/planning/measured_swarm.hpp"
#include "swarmflow/planning/plan_request.hpp"
#include "swarmflow/planning/plan_result.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/cvar.hpp"

namespace swarm::planner {

/// Of what a method promises the risk limit CVaR_α ≤ δ.
enum class RiskPromise {
  kNone,
  kEveryGaussian,  ///< of every Gaussian of the plan, all along its legs
  kMixture,        ///< of the mixture as a whole, at the times of the plan's nodes
};

/// What a method does and promises. Planner, audit and reports ask for it, so that none of them
/// needs to know the method's name.
struct PlanningTraits {
  RiskPromise risk_promise = RiskPromise::kNone;
  /// Robots keep the plan's places and times, so its density and speed must suit their bodies:
  /// Planner checks that. False where the plan is a guide.
  bool is_kept_in_time = false;
  double speed_mps = 0.0;  ///< of the means along their routes; 0 where there is no such number
  std::optional<double> density_cap_per_m2{};  ///< that plans are held to [robots/m²], if any
  bool uses_places = false;                    ///< needs ReportedRobot::leg and ::goal
};

/// How a swarm's flow is planned: the extension point of the planner. A method is registered by
/// name (planning_registry.hpp) and chosen by `planner.method` of the mission.
///
/// All calls come from one thread. A method may keep what it learnt from one call to the next; the
/// same sequence of calls with the same random states gives the same plans. Angles in radians,
/// everything else in SI units, in the frame of the mission's map.
class PlanningMethod {
 public:
  virtual ~PlanningMethod() = default;
  PlanningMethod(const PlanningMethod&) = delete;
  PlanningMethod& operator=(const PlanningMethod&) = delete;

  /// The flow from request.start to request.goal. kInfeasible where there is none: the message
  /// says why, and what to loosen. May take as long as it needs; robots follow their last plan
  /// meanwhile.
  virtual Result<PlanResult> plan(const PlanRequest& request, const PlanContext& context) = 0;

  /// The risk limit in force. The one of the mission until set_risk() is called.
  virtual const RiskLimit& risk() const = 0;
  /// The risk limit of plans from now on; an operator may change it in flight.
  virtual void set_risk(const RiskLimit& risk) = 0;

  virtual PlanningTraits traits() const { return {}; }

  /// The time after which a plan is made anew although nothing has changed, until all robots have
  /// arrived; nothing for a method whose plan holds for the whole mission.
  virtual std::optional<Duration> replan_period() const { return std::nullopt; }

  // In flight a plan starts where the robots are: the planner asks for their groups, plans from
  // these as the start mixture, and tells each robot its group and its share there.

  /// The robots in groups, each robot in one of them. By default robots that stand together, as
  /// group_robots() finds them. kInfeasible where no group keeps the risk limit.
  virtual Result<std::vector<RobotGroup>> measure(const MeasuredSwarm& swarm);

  /// The goal to plan to from measured groups, by default the mission's. It has the same components
  /// with other weights, for methods that have to deal in whole robots.
  virtual Mixture goal_from(const MeasuredSwarm& swarm) const { return swarm.goal; }

  /// Puts the members of each group in another order once the plan is known. Group i is source i
  /// of the plan. By default they stay as measure() put them.
  virtual void order_members(std::vector<RobotGroup>& /*groups*/, const FlowPlan& /*plan*/,
                             const MeasuredSwarm& /*swarm*/) const {}

  /// Many robots make no progress near this place. True when the method's next plan avoids it: then
  /// that plan is made at once.
  virtual bool on_congestion(const Vec2& /*at_m*/) { return false; }

 protected:
  PlanningMethod() = default;
};

}  // namespace swarm::planner
