// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/agent.hpp"

#include <algorithm>
#include <limits>

#include "swarm_core/mission/placement.hpp"

namespace swarm::agent {
namespace {

/// Whether a robot is still where the planner heard it: one that comes back later than that finds
/// its own way into the plan, not back to where its group was.
bool is_near_source(const FlowPlan& plan, std::uint32_t source, const Vec2& position_m) {
  constexpr double kNear_m = 15.0;
  constexpr double kNearSigmas = 5.0;
  const Gaussian& g = plan.nodes()[plan.sources()[source]].gaussian;
  return (position_m - g.mean_m()).norm() <= kNear_m ||
         g.mahalanobis_squared(position_m) <= kNearSigmas * kNearSigmas;
}

constexpr double kArrivedNear_m = 1.0;     // of the own end point
constexpr double kArrivedCrowded_m = 4.0;  // … if the crowd lets nobody nearer
constexpr Duration kCrowdedAfter = std::chrono::seconds(3);
constexpr double kAtRest_m = 0.1;  // from the end point: stay
constexpr double kAtRest_mps = 0.05;

}  // namespace

AgentOptions agent_options(const Mission& mission, RobotId robot, std::uint64_t seed) {
  const RobotsSpec& body = mission.robots;
  const ControlSpec& c = mission.control;
  const LinkSpec& l = mission.link;
  const Duration period = from_seconds(1.0 / c.rate_hz);
  return {
      .robot = robot,
      .share = stratified_share(robot.value(), body.count),
      .seed = mix_seed(seed, robot.value()),
      .route = {.radius_m = body.radius_m},
      .pursuit = {.look_ahead_m = c.look_ahead_s * c.cruise_mps, .radius_m = body.radius_m},
      .attraction = {.cruise_mps = std::min(c.cruise_mps, body.speed_max_mps),
                     .approach_gain_hz = c.approach_gain_hz},
      .neighbour_repulsion = {.radius_m = body.radius_m,
                              .gap_m = c.neighbour_gap_m,
                              .push_mps = c.neighbour_push_mps},
      .obstacle_repulsion = {.radius_m = body.radius_m,
                             .gap_m = c.obstacle_gap_m,
                             .push_mps = c.obstacle_push_mps},
      .safety = {.radius_m = body.radius_m,
                 .speed_max_mps = body.speed_max_mps,
                 .period = period,
                 .gap_share = mission.safety.gap_share,
                 .neighbour_margin_m = mission.safety.neighbour_margin_m,
                 .obstacle_margin_m = mission.safety.obstacle_margin_m,
                 .follow_share = mission.safety.follow_share},
      .kick = {.stuck_after = from_seconds(c.stuck_after_s),
               .duration = from_seconds(c.kick_s),
               .velocity_mps = c.kick_mps},
      .neighbours = {.radius_m = body.radius_m,
                     .speed_max_mps = body.speed_max_mps,
                     .keep_radius_m = 1.5 * l.hear_radius_m,
                     .near_m = l.send_near_m,
                     .near_silence = 3 * period,
                     .expected_silence = from_seconds(l.send_interval_max_s) + 2 * period,
                     .forget_after = from_seconds(mission.timing.neighbour_forget_s)},
      .say = {.error_m = l.send_error_m,
              .interval_max = from_seconds(l.send_interval_max_s),
              .near_m = l.send_near_m},
  };
}

Agent::Agent(const World& world, const AgentOptions& options)
    : world_(world),
      options_(options),
      rng_(options.seed),
      neighbours_(options.neighbours),
      filter_(world, options.safety),
      kick_(options.kick),
      say_(options.say) {}

void Agent::accept_plan(const FlowPlan& plan, const Vec2& position_m,
                        std::optional<PlanEntry> entry) {
  if (route_ && plan.digest() == plan_digest_) return;
  if (entry && is_near_source(plan, entry->source, position_m)) {
    route_ =
        route_from_source(plan, entry->source, entry->share, position_m, world_, options_.route);
  } else if (moved_ || entry) {
    route_ = route_from_here(plan, options_.share, position_m, world_, options_.route);
  } else {
    route_ = route_from_start(plan, options_.share, position_m, world_, options_.route);
  }
  plan_digest_ = plan.digest();
  pursuit_ = Pursuit(route_->path, options_.pursuit);
  kick_.forget();
  arrived_ = false;
  best_remaining_m_ = std::numeric_limits<double>::infinity();
}

bool Agent::has_arrived(const AgentInput& input) {
  const bool inside = route_->goal.contains_99(input.position_m);
  if (arrived_) return inside;
  const double left = (pursuit_.end_m() - input.position_m).norm();
  if (left < best_remaining_m_ - 0.1) {
    best_remaining_m_ = left;
    progress_at_ = input.now;
  }
  const bool crowded = left < kArrivedCrowded_m && input.now - progress_at_ > kCrowdedAfter;
  return inside && (left < kArrivedNear_m || crowded);
}

RobotMode Agent::decide_mode(const AgentInput& input) const {
  if (input.phase == MissionPhase::kStopped) return RobotMode::kStopped;
  if (!route_ || input.phase == MissionPhase::kReady) return RobotMode::kWaiting;
  if (arrived_) return RobotMode::kArrived;
  if (input.phase == MissionPhase::kPaused || !input.planner_alive) return RobotMode::kHolding;
  return RobotMode::kMoving;
}

Vec2 Agent::wish(const AgentInput& input, RobotMode mode) {
  if (mode != RobotMode::kMoving && mode != RobotMode::kArrived) {
    kick_.update(input.now, 0.0, false, rng_);
    return Vec2::Zero();
  }
  const Pursuit::Aim aim = pursuit_.update(input.position_m, world_);
  const Vec2 kick =
      kick_.update(input.now, pursuit_.progress_m(), mode == RobotMode::kMoving, rng_);
  if (mode == RobotMode::kArrived && aim.left_m < kAtRest_m) return Vec2::Zero();
  return attraction(input.position_m, aim.point_m, aim.left_m, options_.attraction) + kick;
}

AgentOutput Agent::tick(const AgentInput& input) {
  if (route_ && input.phase != MissionPhase::kReady) arrived_ = has_arrived(input);
  AgentOutput out;
  out.mode = decide_mode(input);
  moved_ = moved_ || out.mode == RobotMode::kMoving;

  const std::span<const Neighbour> neighbours = neighbours_.at(input.now, input.position_m);
  out.nearest_gap_m = std::numeric_limits<double>::infinity();
  for (const Neighbour& n : neighbours) {
    const double gap = (n.position_m - input.position_m).norm() - 2.0 * options_.safety.radius_m;
    out.nearest_gap_m = std::min(out.nearest_gap_m, gap);
  }
  out.neighbours = static_cast<std::uint16_t>(std::min<std::size_t>(neighbours.size(), 0xFFFF));
  out.remaining_m = route_ ? pursuit_.remaining_m() : 0.0;

  if (out.mode != RobotMode::kStopped) {
    const Vec2 wished =
        wish(input, out.mode) +
        neighbour_repulsion(input.position_m, neighbours, options_.neighbour_repulsion) +
        obstacle_repulsion(input.position_m, world_, options_.obstacle_repulsion);
    out.velocity_mps = filter_.filter(input.position_m, wished, neighbours);
  }
  out.settled = out.mode == RobotMode::kArrived && out.velocity_mps.norm() < kAtRest_mps;

  out.say = say_.must_say(input.now, input.position_m, out.velocity_mps, out.nearest_gap_m);
  if (out.say) say_.said(input.now, input.position_m, out.velocity_mps);
  return out;
}

}  // namespace swarm::agent
