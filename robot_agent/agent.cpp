// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/agent.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robot_agent/route/detour.hpp"
#include "swarm_core/mission/placement.hpp"

namespace swarm::agent {
namespace {

/// Whether a robot is still near the position that the planner last received from it. One whose
/// process was down for longer enters the plan from where it is, instead of driving back to where
/// its group was.
bool is_near_source(const FlowPlan& plan, std::uint32_t source, const Vec2& position_m,
                    double scale) {
  constexpr double kNear_m = 15.0;
  constexpr double kNearSigmas = 5.0;
  const Gaussian& g = plan.nodes()[plan.sources()[source]].gaussian;
  return (position_m - g.mean_m()).norm() <= scale * kNear_m ||
         g.mahalanobis_squared(position_m) <= kNearSigmas * kNearSigmas;
}

constexpr double kAtRest_mps = 0.05;
constexpr double kFinalApproach_m = 4.0;  // nearer to the end, robots do not turn aside
// Time constant of the mean of the commanded velocity.
constexpr double kMeanOver_s = 2.0;

}  // namespace

AgentIdentity agent_identity(const Mission& mission, RobotId robot) {
  return {.robot = robot, .share = stratified_share(robot.value(), mission.robots.count)};
}

Agent::Agent(const World& world, Shared<AgentOptions> options, const AgentIdentity& self)
    : world_(&world),
      options_(std::move(options)),
      mean_share_(std::min(1.0, to_seconds(options_->safety.period) / kMeanOver_s)),
      neighbours_(options_.part(&AgentOptions::neighbours)),
      filter_(world, options_.part(&AgentOptions::safety)),
      send_policy_(options_.part(&AgentOptions::send)),
      method_(options_->control.make()),
      moved_(self.underway),
      followed_route_{.share = self.share} {}

/// Chooses how the robot enters the plan: at the source that the planner names, if it is still
/// there; from where it is, once it has moved; otherwise at the plan's beginning.
bool Agent::accept_plan(const FlowPlan& plan, const Vec2& position_m,
                        std::optional<PlanEntry> entry, std::optional<double> plan_time_s) {
  if (has_route_ && plan.digest() == followed_route_.plan_digest) {
    if (arrived_ || !is_path_blocked()) return false;
    entry.reset();  // it is for where the robot was when the plan was made
  }
  const RouteOptions& o = options_->route;
  Route route =
      entry && is_near_source(plan, entry->source, position_m, options_->scale)
          ? route_from_source(plan, entry->source, entry->share, position_m, *world_, o)
      : moved_ || entry
          ? route_from_here(plan, followed_route_.share, position_m, *world_, o, plan_time_s)
          : route_from_start(plan, followed_route_.share, position_m, *world_, o);
  keep_slot(route, position_m);
  method_.begin(plan, route, *world_);
  followed_route_.goal = route.goal;
  followed_route_.path = std::move(route.path);
  followed_route_.end_s = route.schedule.end_s();
  has_route_ = true;
  followed_route_.plan_digest = plan.digest();
  arrived_ = false;
  return true;
}

bool Agent::is_path_blocked() const {
  const Polyline& path = followed_route_.path;
  return is_blocked_by_body(path, path.length_m() - method_.remaining_m(), *world_,
                            detour_options(options_->route));
}

/// A robot that is in its goal already keeps its slot there: a new slot with each plan would
/// disturb the robots that wait for the last ones. It goes there in the time of the new plan.
void Agent::keep_slot(Route& route, const Vec2& position_m) const {
  constexpr double kSame_m = 1e-6;
  const bool same_goal =
      has_route_ && (route.goal.mean_m() - followed_route_.goal.mean_m()).norm() < kSame_m;
  if (!same_goal || !route.goal.contains_99(position_m)) return;
  const Vec2& end_m = followed_route_.path.vertices_m().back();
  if (!route.goal.contains_99(end_m)) return;  // bodies had moved it out
  if (!world_->segment_is_free(position_m, end_m, options_->route.radius_m)) return;
  // In no more time than it had left; otherwise each new plan would put its arrival off.
  const auto before = method_.tracking();
  const double left_s =
      before ? std::max(1.0, followed_route_.end_s - before->plan_time_s) : followed_route_.end_s;
  const double end_s = std::min(route.schedule.end_s(), left_s);
  route.path = Polyline({position_m, end_m});
  route.schedule = arrived_ ? Schedule({{0.0, route.path.length_m()}})
                            : Schedule({{0.0, 0.0}, {end_s, route.path.length_m()}});
}

/// The first that applies: a stop holds in any state, and a robot that has arrived stays arrived
/// when the mission pauses or the planner is silent.
[[gnu::hot]] RobotMode Agent::decide_mode(const AgentInput& input) const {
  if (input.phase == MissionPhase::kStopped || !method_.fault().empty()) return RobotMode::kStopped;
  if (!has_route_ || input.phase == MissionPhase::kReady) return RobotMode::kWaiting;
  if (arrived_) return RobotMode::kArrived;
  if (input.phase == MissionPhase::kPaused || !input.planner_alive || !input.may_move) {
    return RobotMode::kHolding;
  }
  return RobotMode::kMoving;
}

/// What the control method proposes, bounded by the safety filter. An arrived robot drives, too: it
/// keeps its slot and makes room. Any other holds its position and lets itself be pushed.
[[gnu::hot]] Vec2 Agent::filtered_velocity(const ControlView& view, const AgentOutput& out,
                                           Rng& rng) {
  const bool drives = out.mode == RobotMode::kMoving || out.mode == RobotMode::kArrived;
  const Vec2 desired = drives ? method_.desired_velocity(view, arrived_, rng) : method_.hold(view);
  const bool gives_way =
      out.mode == RobotMode::kMoving && out.remaining_m > options_->scale * kFinalApproach_m;
  return filter_.filter(view.position_m, desired, view.close, gives_way);
}

/// Estimates the neighbours, has the control method propose a velocity, bounds it by the safety
/// filter, and decides whether to publish the new state.
[[gnu::hot]] AgentOutput Agent::tick(const AgentInput& input, Rng& rng) {
  const Neighbourhood neighbourhood = neighbours_.at(input.now, input.position_m, input.silent);
  const ControlView view{.now = input.now,
                         .position_m = input.position_m,
                         .neighbours = neighbourhood.all,
                         .world = *world_,
                         .close = neighbourhood.close,
                         .plan_time = input.plan_time,
                         .planned_density = input.planned_density};
  if (has_route_ && input.phase != MissionPhase::kReady) arrived_ = method_.has_arrived(view);
  AgentOutput out;
  out.mode = decide_mode(input);
  moved_ = moved_ || out.mode == RobotMode::kMoving;
  out.estimated = view.neighbours;
  out.neighbours = static_cast<std::uint16_t>(std::min<std::size_t>(neighbours_.known(), 0xFFFF));
  out.remaining_m = has_route_ ? method_.remaining_m() : 0.0;

  if (out.mode != RobotMode::kStopped && input.may_move) {
    out.velocity_mps = neighbourhood.is_within_silent ? filter_.stand(input.position_m, view.close)
                                                      : filtered_velocity(view, out, rng);
  }
  if (has_route_) out.tracking = method_.tracking();
  // With measurement noise a robot never stops entirely. It counts as settled if its commanded
  // velocity, now or averaged over two seconds, is negligible.
  mean_mps_ += mean_share_ * (out.velocity_mps - mean_mps_);
  out.settled = out.mode == RobotMode::kArrived &&
                std::min(out.velocity_mps.norm(), mean_mps_.norm()) < options_->scale * kAtRest_mps;

  // Followers rely on the published velocity: a body with a lag publishes the measured one.
  out.reported_mps = input.velocity_mps.value_or(out.velocity_mps);
  const SendInput state{
      .now = input.now,
      .position_m = input.position_m,
      .velocity_mps = out.reported_mps,
      .listeners = filter_.listeners(input.position_m, out.reported_mps, view.close),
      .link = neighbours_.link()};
  out.nearest_gap_m = state.listeners.nearest_gap_m;
  out.send = send_policy_.must_send(state);
  if (out.send) send_policy_.record_sent(state);
  return out;
}

}  // namespace swarm::agent
