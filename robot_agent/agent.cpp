// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/agent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robot_agent/drivers/lag.hpp"
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

constexpr double kAtRest_mps = 0.05;
constexpr double kSettling_m = 4.0;  // nearer to the end than this a turn aside would only stir
constexpr double kMeanOver_s = 2.0;

/// What the filter keeps off obstacles: a measured place may be off, and a step.
double obstacle_margin_m(const Mission& mission, const BodySpec& body) {
  return mission.safety.obstacle_margin_m +
         2.0 * std::hypot(body.position_noise_m, body.motion_noise_m);
}

/// From where on another robot matters to none of the method's forces.
double force_reach_m(const ControlSpec& control, double bodies_m) {
  if (control.method == "apf") {
    const double kernel_m =
        control.density_push_mps > 0.0 ? DensityAttractionOptions{}.kernel_m : 0.0;
    return std::max(bodies_m + control.neighbour_gap_m, kernel_m);
  }
  const HeadingFieldOptions heading;
  constexpr double kSigmas = 2.5;  // farther headings weigh less than 5 %
  return std::max(SeparationFieldOptions{}.reach_m, heading.mean_m + kSigmas * heading.sigma_m);
}

/// In a crowd gaps are as small as the filter's margin: what presses begins well above.
double room_gap_m(const Mission& mission) { return mission.safety.neighbour_margin_m + 0.5; }

double fastest_mps(const RobotsSpec& robots) {
  double fastest = robots.speed_max_mps;
  for (const RobotGroupSpec& group : robots.groups) {
    fastest = std::max(fastest, group.speed_max_mps);
  }
  return fastest;
}

/// From where on it matters neither to the filter, nor to forces of contact, nor to what we say.
double close_m(const Mission& mission, const BodySpec& body) {
  const double period_s = 1.0 / mission.control.rate_hz;
  const double margin_m = mission.safety.neighbour_margin_m;
  const double braking_s = period_s / mission.safety.gap_share + lag_s(body);
  const double brake_m = margin_m + 2.0 * body.speed_max_mps * braking_s;
  // One that follows us, or that stalled unheard and was left behind, goes on for so long.
  const double unheard_s = 2.0 * period_s + lag_s(body) + mission.link.send_interval_max_s;
  const double follows_m = margin_m + fastest_mps(mission.robots) * unheard_s;
  const double pressing_m = std::max(mission.control.neighbour_gap_m, room_gap_m(mission));
  return body.radius_m + largest_radius_m(mission.robots) +
         std::max({brake_m, follows_m, mission.link.send_near_m, pressing_m});
}

/// From where on it matters to nothing.
double reach_m(const Mission& mission, const BodySpec& body, double keep_m) {
  // Its range is the sensing range.
  if (mission.control.method == "intermittent_diffusion") return keep_m;
  const double bodies_m = body.radius_m + largest_radius_m(mission.robots);
  return std::max(close_m(mission, body), force_reach_m(mission.control, bodies_m));
}

CropsOptions crops_options(const Mission& mission, const BodySpec& body) {
  const ControlSpec& c = mission.control;
  const double cruise_mps = std::min(c.cruise_mps, body.speed_max_mps);
  const auto ticks = [&](double time_s) {
    return static_cast<std::size_t>(std::max(1.0, std::round(time_s * c.rate_hz)));
  };
  return {
      .cruise_mps = cruise_mps,
      .approach_gain_hz = c.approach_gain_hz,
      .guide = {.radius_m = body.radius_m,
                .passable_m = obstacle_margin_m(mission, body) + 0.01,
                .goal_radius_m = mission.planner.crops_goal_radius_m,
                .sight_m = c.look_ahead_s * cruise_mps},
      .place = {.radius_m = body.radius_m,
                .room_gap_m = room_gap_m(mission),
                .approach_gain_hz = c.approach_gain_hz},
      .obstacle = {.radius_m = body.radius_m},
      .give_way = {.radius_m = body.radius_m, .gap_m = mission.safety.neighbour_margin_m + 0.1},
      .escape = {.window = ticks(c.stuck_after_s), .step = ticks(c.escape_s)},
  };
}

IntermittentDiffusionOptions diffusion_options(const Mission& mission, const BodySpec& body) {
  const ControlSpec& c = mission.control;
  return {.shape = mission.goal_shape,
          .goal = mission.goal,
          .repulsion = {.strength_m2 = c.diffusion_strength_m2,
                        .range_m =
                            c.diffusion_range_m > 0.0 ? c.diffusion_range_m : 10.0 * body.radius_m},
          .diffusion = {.noise_mps05 = c.diffusion_noise_mps05,
                        .time_s = c.diffusion_time_s,
                        .clearance_m = body.radius_m + mission.safety.obstacle_margin_m},
          .obstacles = {.radius_m = body.radius_m,
                        .gap_m = c.obstacle_gap_m,
                        .push_mps = c.obstacle_push_mps},
          .radius_m = body.radius_m,
          .tolerance_m2 = c.diffusion_tolerance_m2,
          .gain_hz = c.diffusion_gain_hz,
          .cruise_mps = std::min(c.cruise_mps, body.speed_max_mps),
          .period = from_seconds(1.0 / c.rate_hz),
          .flow_time = from_seconds(c.diffusion_flow_s)};
}

std::variant<Apf, Crops, IntermittentDiffusion> make_method(const Shared<AgentOptions>& options) {
  if (options->method == "intermittent_diffusion") {
    return IntermittentDiffusion(options.part(&AgentOptions::diffusion));
  }
  if (options->method == "crops") return Crops(options.part(&AgentOptions::crops));
  return Apf(options.part(&AgentOptions::apf));
}

}  // namespace

Shared<AgentOptions> agent_options(const Mission& mission, RobotId robot) {
  const BodySpec& body = body_of(mission.robots, robot);
  const ControlSpec& c = mission.control;
  const LinkSpec& l = mission.link;
  const Duration period = from_seconds(1.0 / c.rate_hz);
  const double cruise_mps = std::min(c.cruise_mps, body.speed_max_mps);
  const double hear_m = body.hear_radius_m > 0.0 ? body.hear_radius_m : l.hear_radius_m;
  return AgentOptions{
      .method = c.method,
      .route = {.radius_m = body.radius_m},
      .apf = {.keeps_time = c.tracking == "plan",
              .pursuit = {.look_ahead_m = c.look_ahead_s * cruise_mps,
                          .radius_m = body.radius_m,
                          .keep_clearance_m = c.keep_clearance_m},
              .pace = {.look_ahead_s = c.look_ahead_s,
                       .gain_hz = c.pace_gain_hz,
                       .approach_gain_hz = c.approach_gain_hz,
                       .cruise_mps = cruise_mps},
              .density = {.push_mps = c.density_push_mps},
              .neighbour_repulsion = {.radius_m = body.radius_m,
                                      .gap_m = c.neighbour_gap_m,
                                      .push_mps = c.neighbour_push_mps},
              .obstacle_repulsion = {.radius_m = body.radius_m,
                                     .gap_m = c.obstacle_gap_m,
                                     .push_mps = c.obstacle_push_mps},
              .escape = {.stuck_after = from_seconds(c.stuck_after_s),
                         .duration = from_seconds(c.escape_s),
                         .spread_m = c.escape_spread_m,
                         .radius_m = body.radius_m}},
      .diffusion = diffusion_options(mission, body),
      .crops = crops_options(mission, body),
      .safety = {.radius_m = body.radius_m,
                 .speed_max_mps = body.speed_max_mps,
                 .period = period,
                 .lag_s = lag_s(body),
                 .gap_share = mission.safety.gap_share,
                 .stale_gain = mission.safety.stale_gain,
                 .neighbour_margin_m = mission.safety.neighbour_margin_m,
                 .obstacle_margin_m = obstacle_margin_m(mission, body),
                 .follow_share = mission.safety.follow_share},
      .neighbours = {.radius_m = body.radius_m,
                     .fleet = Fleet(mission.robots),
                     .keep_radius_m = hear_m,
                     .reach_m = reach_m(mission, body, hear_m),
                     .close_m = close_m(mission, body),
                     .reach_growth_mps = 2.0 * body.speed_max_mps * mission.safety.stale_gain /
                                         mission.safety.gap_share,
                     .near_m = l.send_near_m,
                     .period = period,
                     .expected_silence = from_seconds(l.send_interval_max_s) + 2 * period,
                     .forget_after = from_seconds(mission.timing.neighbour_forget_s)},
      .say = {.error_m = l.send_error_m,
              .interval_max = from_seconds(l.send_interval_max_s),
              .near_m = l.send_near_m,
              .period = period},
  };
}

AgentIdentity agent_identity(const Mission& mission, RobotId robot) {
  return {.robot = robot, .share = stratified_share(robot.value(), mission.robots.count)};
}

Agent::Agent(const World& world, Shared<AgentOptions> options, const AgentIdentity& self)
    : world_(&world),
      options_(std::move(options)),
      mean_share_(std::min(1.0, to_seconds(options_->safety.period) / kMeanOver_s)),
      neighbours_(options_.part(&AgentOptions::neighbours)),
      filter_(world, options_.part(&AgentOptions::safety)),
      say_(options_.part(&AgentOptions::say)),
      method_(make_method(options_)),
      moved_(self.underway),
      way_{.share = self.share} {}

void Agent::accept_plan(const FlowPlan& plan, const Vec2& position_m,
                        std::optional<PlanEntry> entry, std::optional<double> plan_time_s) {
  if (has_route_ && plan.digest() == way_.plan_digest) return;
  const RouteOptions& o = options_->route;
  Route route = entry && is_near_source(plan, entry->source, position_m)
                    ? route_from_source(plan, entry->source, entry->share, position_m, *world_, o)
                : moved_ || entry
                    ? route_from_here(plan, way_.share, position_m, *world_, o, plan_time_s)
                    : route_from_start(plan, way_.share, position_m, *world_, o);
  keep_place(route, position_m);
  method().see_goals(plan);
  method().begin(route, *world_);
  way_.goal = route.goal;
  way_.end_m = route.path.vertices_m().back();
  way_.end_s = route.schedule.end_s();
  has_route_ = true;
  way_.plan_digest = plan.digest();
  way_.begin_m = route.path.at(0.0);
  arrived_ = false;
}

/// A robot that is in its goal already keeps the place it was going to there: new plans would
/// stir those who wait for the last ones. It goes there in the time of the new plan.
void Agent::keep_place(Route& route, const Vec2& position_m) const {
  constexpr double kSame_m = 1e-6;
  const bool same_goal = has_route_ && (route.goal.mean_m() - way_.goal.mean_m()).norm() < kSame_m;
  if (!same_goal || !route.goal.contains_99(position_m)) return;
  if (!world_->segment_is_free(position_m, way_.end_m, options_->route.radius_m)) return;
  // In no more time than it had left: each plan would put its arrival off else.
  const auto before = method().tracking();
  const double left_s = before ? std::max(1.0, way_.end_s - before->plan_time_s) : way_.end_s;
  const double end_s = std::min(route.schedule.end_s(), left_s);
  route.path = Polyline({position_m, way_.end_m});
  route.schedule = arrived_ ? Schedule({{0.0, route.path.length_m()}})
                            : Schedule({{0.0, 0.0}, {end_s, route.path.length_m()}});
}

RobotMode Agent::decide_mode(const AgentInput& input) const {
  if (input.phase == MissionPhase::kStopped) return RobotMode::kStopped;
  if (!has_route_ || input.phase == MissionPhase::kReady) return RobotMode::kWaiting;
  if (arrived_) return RobotMode::kArrived;
  if (input.phase == MissionPhase::kPaused || !input.planner_alive) return RobotMode::kHolding;
  return RobotMode::kMoving;
}

AgentOutput Agent::tick(const AgentInput& input, Rng& rng) {
  const Neighbourhood hood = neighbours_.at(input.now, input.position_m);
  const ControlView view{.now = input.now,
                         .position_m = input.position_m,
                         .neighbours = hood.all,
                         .world = *world_,
                         .close = hood.close,
                         .plan_time = input.plan_time,
                         .planned_density = input.planned_density};
  if (has_route_ && input.phase != MissionPhase::kReady) arrived_ = method().has_arrived(view);
  AgentOutput out;
  out.mode = decide_mode(input);
  moved_ = moved_ || out.mode == RobotMode::kMoving;
  out.believed = view.neighbours;
  out.neighbours = static_cast<std::uint16_t>(std::min<std::size_t>(neighbours_.known(), 0xFFFF));
  out.remaining_m = has_route_ ? method().remaining_m() : 0.0;

  if (out.mode != RobotMode::kStopped) {
    const bool drives = out.mode == RobotMode::kMoving || out.mode == RobotMode::kArrived;
    const Vec2 wished = drives ? method().wish(view, arrived_, rng) : method().hold(view);
    const bool gives_way = out.mode == RobotMode::kMoving && out.remaining_m > kSettling_m;
    out.velocity_mps = filter_.filter(input.position_m, wished, view.close, gives_way);
  }
  if (has_route_) out.tracking = method().tracking();
  // With noise in what it measures a robot never stands; where it goes nowhere, it rests.
  mean_mps_ += mean_share_ * (out.velocity_mps - mean_mps_);
  out.settled = out.mode == RobotMode::kArrived &&
                std::min(out.velocity_mps.norm(), mean_mps_.norm()) < kAtRest_mps;

  out.told_mps = input.velocity_mps.value_or(out.velocity_mps);
  const SayInput word{.now = input.now,
                      .position_m = input.position_m,
                      .velocity_mps = out.told_mps,
                      .listeners = filter_.listeners(input.position_m, out.told_mps, view.close),
                      .link = neighbours_.link()};
  out.nearest_gap_m = word.listeners.nearest_gap_m;
  out.say = say_.must_say(word);
  if (out.say) say_.said(word);
  return out;
}

}  // namespace swarm::agent
