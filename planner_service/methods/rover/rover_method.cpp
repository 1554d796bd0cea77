// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/rover_method.hpp"

#include <algorithm>
#include <utility>

#include "planner_service/methods/rover/flow_groups.hpp"
#include "planner_service/methods/rover/plan_excess.hpp"
#include "planner_service/methods/shared/route_plan.hpp"
#include "planner_service/methods/shared/shared_keys.hpp"
#include "planner_service/stage_timer.hpp"

namespace swarm::planner {
namespace {

/// Whether two mixtures differ only in their weights: the graph depends on the components alone.
bool have_same_components(const Mixture& a, const Mixture& b) {
  return std::equal(a.components().begin(), a.components().end(), b.components().begin(),
                    b.components().end(), [](const auto& l, const auto& r) {
                      return l.gaussian.mean_m() == r.gaussian.mean_m() &&
                             l.gaussian.covariance_m2() == r.gaussian.covariance_m2();
                    });
}

/// How many robots are led to each goal component.
std::vector<std::size_t> led_to(const MeasuredSwarm& swarm) {
  std::vector<std::size_t> led(swarm.goal.components().size(), 0);
  for (const ReportedRobot& robot : swarm.robots) {
    if (robot.goal) ++led.at(*robot.goal);
  }
  return led;
}

/// Options of rover in a mission.
struct RoverKeys : CollocationKeys {
  std::uint32_t horizon = 3;
  double replan_period_s = 1.0;
};

const OptionTable<RoverKeys>& rover_keys() {
  static const auto table =
      OptionTable<RoverKeys>()
          .with(collocation_keys())
          .count("horizon", &RoverKeys::horizon, between(1, 10),
                 "number of steps planned ahead (h in ROVER)")
          .number("replan_period_s", &RoverKeys::replan_period_s, between(0.1, 3600),
                  "time between two plans from the robots' present positions");
  return table;
}

}  // namespace

const std::vector<OptionSpec>& RoverMethod::keys() { return rover_keys().specs(); }

RoverOptions rover_options(const Mission& mission) {
  const PlannerSpec& spec = mission.planner;
  const RoverKeys keys = rover_keys().read(spec.options);
  return {.graph = {.collocation = {.spacing_m = keys.collocation_spacing_m,
                                    .sigma_m = keys.collocation_sigma_m},
                    .transport_radius_m = keys.transport_radius_m,
                    .risk = {.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m}},
          .mpc = {.costs = {.horizon = keys.horizon},
                  .density_cap_per_m2 = spec.density_cap_per_m2.value_or(0.0),
                  .robots = static_cast<double>(mission.robots.count)},
          .speed_mps = spec.speed_mps};
}

RoverMethod::RoverMethod(const RoverOptions& options, Duration replan_period)
    : options_(options), replan_period_(replan_period) {}

Result<std::unique_ptr<PlanningMethod>> RoverMethod::make(const MethodContext& context) {
  return std::make_unique<RoverMethod>(
      rover_options(context.mission),
      from_seconds(rover_keys().read(context.options()).replan_period_s));
}

PlanningTraits RoverMethod::traits() const {
  const double cap_per_m2 = options_.mpc.density_cap_per_m2;
  PlanningTraits traits{.risk_promise = RiskPromise::kMixture,
                        .is_kept_in_time = true,
                        .speed_mps = options_.speed_mps,
                        .uses_positions = true};
  if (cap_per_m2 > 0.0) traits.density_cap_per_m2 = cap_per_m2;
  return traits;
}

// The planner of a map and a goal. Making one builds the risk graph, the offline stage of the
// paper, so that it is kept until the map or the goal components change.
Result<Rover*> RoverMethod::rover_for(const World& world, const Mixture& goal) {
  if (!rover_ || !(world_ == world) || !have_same_components(goal_, goal)) {
    rover_.reset();
    world_ = world;
    goal_ = goal;
    auto made = Rover::make(world_, goal_, options_);
    if (!made) return tl::unexpected(made.error());
    rover_.emplace(*std::move(made));
  }
  return &*rover_;
}

Result<PlanResult> RoverMethod::plan(const PlanRequest& request, const PlanContext& context) {
  StageTimer stage(context.clock);
  auto ready = rover_for(request.world, request.goal);
  if (!ready) return tl::unexpected(ready.error());
  PlanResult result;
  result.stats.roadmap_ms = stage.lap_ms();
  auto mission = (*ready)->plan(request.start, request.goal);
  if (!mission) return tl::unexpected(mission.error());
  result.stats.transport_ms = stage.lap_ms();
  result.excess = excess_of(mission->plan, request.world, risk(), options_.graph.checks_between);
  measure_flow(result.stats, mission->plan);
  result.plan = std::move(mission->plan);
  return result;
}

// The risk enters the arc lengths of the graph: it is built again.
void RoverMethod::set_risk(const RiskLimit& risk) {
  options_.graph.risk = risk;
  rover_.reset();
}

// Robots in motion may already violate (11g), and an infeasible plan would leave them without one:
// from here on excess is penalised instead of refused.
Result<std::vector<RobotGroup>> RoverMethod::measure(const MeasuredSwarm& swarm) {
  if (!options_.mpc.soften) {
    options_.mpc.soften = true;
    rover_.reset();
  }
  const auto ready = rover_for(swarm.world, swarm.goal);
  if (!ready) return tl::unexpected(ready.error());
  return group_by_flow(swarm.robots, (*ready)->graph(), swarm.goal, {});
}

Mixture RoverMethod::goal_from(const MeasuredSwarm& swarm) const {
  return goal_in_robots(swarm.goal, led_to(swarm), swarm.robots.size(), swarm.world, risk());
}

void RoverMethod::order_members(std::vector<RobotGroup>& groups, const FlowPlan& plan,
                                const MeasuredSwarm& swarm) const {
  order_by_flow(groups, plan, swarm.goal, swarm.robots);
}

}  // namespace swarm::planner
