// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/agent_options.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "robot_agent/margins.hpp"
#include "swarm_core/base/assert.hpp"
#include "swarm_core/mission/body_scale.hpp"

namespace swarm::agent {
namespace {

/// Distance beyond which a robot matters neither to the safety filter, nor to forces of contact,
/// nor to when a state is published [m].
double close_m(const Mission& mission, const BodySpec& body, double press_gap_m) {
  const double lag_s = body_lag_s(body);
  const double period_s = 1.0 / mission.control.rate_hz;
  const double margin_m = mission.safety.neighbour_margin_m;
  const double braking_s = period_s / mission.safety.gap_share + lag_s;
  // The safety filter's first line bounds a velocity below v_max where gap < m + 2T v_max/γ.
  const double brake_m = margin_m + 2.0 * body.speed_max_mps * braking_s;
  // For this long a follower drives on behind a robot that stopped unnoticed: the silence allowed
  // to it, the two periods that a command lasts, and the lag.
  const double unnoticed_s = 2.0 * period_s + lag_s + mission.link.send_interval_max_s;
  const double follows_m = margin_m + largest_speed_mps(mission.robots) * unnoticed_s;
  const double pressing_m = std::max(press_gap_m, room_gap_m(mission, body));
  return body.radius_m + largest_radius_m(mission.robots) +
         std::max({brake_m, follows_m, mission.link.send_near_m, pressing_m});
}

std::vector<std::string_view> names_of(const ControlRegistry& registry) {
  std::vector<std::string_view> names;
  for (const ControlEntry& entry : registry.all()) names.emplace_back(entry.spec.name);
  return names;
}

}  // namespace

/// Translates the mission's sections and the robot's body into the options of the agent's parts.
Result<Shared<AgentOptions>> agent_options(const Mission& mission, RobotId robot,
                                           const ControlRegistry& registry) {
  const BodySpec& body = body_of(mission.robots, robot);
  const ControlSpec& c = mission.control;
  const LinkSpec& l = mission.link;
  const Duration period = from_seconds(1.0 / c.rate_hz);
  const double scale = length_scale(body);
  const double communication_radius_m =
      body.communication_radius_m > 0.0 ? body.communication_radius_m : l.communication_radius_m;
  const ControlEntry* entry = registry.find(c.method);
  if (entry == nullptr) {
    return fail(ErrorCode::kBadInput, fmt::format("control.method is {}; this program has {}",
                                                  c.method, fmt::join(names_of(registry), ", ")));
  }
  auto control = entry->prepare({.mission = mission, .body = body});
  if (!control) return tl::unexpected(control.error());
  const double near_m = close_m(mission, body, control->press_gap_m);
  // Methods that read all neighbours have an infinite reach: then the communication radius limits
  // it.
  const double matters_m =
      std::isinf(control->reach_m) ? communication_radius_m : std::max(near_m, control->reach_m);
  return Shared<AgentOptions>(AgentOptions{
      .control = std::move(*control),
      .route = {.radius_m = body.radius_m,
                .vertex_clearance_m = scale * RouteOptions{}.vertex_clearance_m,
                .leg_clearance_m = scale * RouteOptions{}.leg_clearance_m,
                .scale = scale},
      .safety = {.radius_m = body.radius_m,
                 .speed_max_mps = body.speed_max_mps,
                 .period = period,
                 .lag_s = body_lag_s(body),
                 .gap_share = mission.safety.gap_share,
                 .stale_gain = mission.safety.stale_gain,
                 .neighbour_margin_m = mission.safety.neighbour_margin_m,
                 .obstacle_margin_m = obstacle_margin_m(mission, body),
                 .follow_share = mission.safety.follow_share,
                 .scale = scale},
      .neighbours = {.radius_m = body.radius_m,
                     .fleet = Fleet(mission.robots),
                     .communication_radius_m = communication_radius_m,
                     .reach_m = matters_m,
                     .close_m = near_m,
                     // The filter's 2T v_max/γ per second that information is older, as T grows by
                     // a τ.
                     .reach_growth_mps = 2.0 * body.speed_max_mps * mission.safety.stale_gain /
                                         mission.safety.gap_share,
                     .near_m = l.send_near_m,
                     .period = period,
                     .expected_silence = from_seconds(l.send_interval_max_s) + 2 * period,
                     .forget_after = from_seconds(mission.timing.neighbour_forget_s),
                     .scale = scale},
      .send = {.error_m = l.send_error_m,
               .interval_max = from_seconds(l.send_interval_max_s),
               .near_m = l.send_near_m,
               .period = period,
               .scale = scale},
      .pose = PoseLimits::of(body),
      .scale = scale,
  });
}

Shared<AgentOptions> agent_options(const Mission& mission, RobotId robot) {
  auto options = agent_options(mission, robot, builtin_control());
  SWARM_ASSERT(options.has_value());
  return *std::move(options);
}

Result<AgentOptionsOf> AgentOptionsOf::make(const Mission& mission,
                                            const ControlRegistry& registry) {
  // Robots with the same body share one immutable set of options.
  std::map<const BodySpec*, Shared<AgentOptions>> by_body;
  for (std::uint32_t id = 0; id < mission.robots.count; ++id) {
    const auto [found, is_new] = by_body.try_emplace(&body_of(mission.robots, RobotId(id)));
    if (!is_new) continue;
    auto options = agent_options(mission, RobotId(id), registry);
    if (!options) return tl::unexpected(options.error());
    found->second = *std::move(options);
  }
  return AgentOptionsOf(mission, std::move(by_body));
}

AgentOptionsOf::AgentOptionsOf(const Mission& mission,
                               std::map<const BodySpec*, Shared<AgentOptions>> by_body)
    : mission_(&mission), by_body_(std::move(by_body)) {}

AgentOptionsOf::AgentOptionsOf(const Mission& mission) : mission_(&mission) {
  auto made = make(mission, builtin_control());
  SWARM_ASSERT(made.has_value());
  by_body_ = std::move(made->by_body_);
}

bool AgentOptionsOf::reads_density() const {
  return std::any_of(by_body_.begin(), by_body_.end(),
                     [](const auto& made) { return made.second->control.reads_density; });
}

const Shared<AgentOptions>& AgentOptionsOf::operator()(RobotId robot) const {
  return by_body_.at(&body_of(mission_->robots, robot));
}

}  // namespace swarm::agent
