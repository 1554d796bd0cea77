// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/validation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <utility>

#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/wire_bounds.hpp"

namespace swarm::link {

namespace {

using Verdict = Checked<void>;

tl::unexpected<RefusalReason> refuse(RefusalReason reason) {
  return tl::unexpected<RefusalReason>(reason);
}

template <class... Numbers>
bool all_finite(Numbers... numbers) {
  return (std::isfinite(numbers) && ...);
}

template <class Enum>
bool is_one_of_first(Enum value, Enum last) {
  return static_cast<std::uint8_t>(value) <= static_cast<std::uint8_t>(last);
}

bool is_inside(double x_m, double y_m, const WireLimits& limits) {
  return limits.bounds_m.distance_m({x_m, y_m}) <= limits.bounds_slack_m;
}

bool is_printable(const std::string& text) {
  return std::none_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;  // would steer a terminal
  });
}

// |a − b|, saturating: both may be anything.
std::int64_t distance(std::int64_t a, std::int64_t b) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(a, b, &difference)) return std::numeric_limits<std::int64_t>::max();
  if (difference == std::numeric_limits<std::int64_t>::min()) {
    return std::numeric_limits<std::int64_t>::max();
  }
  return std::abs(difference);
}

Verdict check_node(const PlanNodeMessage& node, const WireLimits& limits) {
  if (!all_finite(node.mean_x_m, node.mean_y_m, node.covariance_xx_m2, node.covariance_xy_m2,
                  node.covariance_yy_m2, node.time_s, node.mass)) {
    return refuse(RefusalReason::kNotFinite);
  }
  if (!is_inside(node.mean_x_m, node.mean_y_m, limits) || node.time_s < 0.0) {
    return refuse(RefusalReason::kOutOfRange);
  }
  return {};
}

Verdict check_leg(const PlanLegMessage& leg, const std::vector<PlanNodeMessage>& nodes) {
  if (!std::isfinite(leg.mass)) return refuse(RefusalReason::kNotFinite);
  if (leg.from_node >= nodes.size() || leg.to_node >= nodes.size() ||
      !(nodes[leg.from_node].time_s < nodes[leg.to_node].time_s)) {
    return refuse(RefusalReason::kOutOfRange);
  }
  return {};
}

template <class Node>
Checked<Gaussian> to_gaussian(const Node& node) {
  Mat2 covariance_m2;
  covariance_m2 << node.covariance_xx_m2, node.covariance_xy_m2, node.covariance_xy_m2,
      node.covariance_yy_m2;
  auto gaussian = Gaussian::make({node.mean_x_m, node.mean_y_m}, covariance_m2);
  if (!gaussian) return refuse(RefusalReason::kBadGaussian);
  return *std::move(gaussian);
}

}  // namespace

std::string_view to_string(RefusalReason reason) {
  switch (reason) {
    case RefusalReason::kUndecodable:
      return "undecodable";
    case RefusalReason::kSchema:
      return "schema";
    case RefusalReason::kOversized:
      return "oversized";
    case RefusalReason::kNotFinite:
      return "not-finite";
    case RefusalReason::kOutOfRange:
      return "out-of-range";
    case RefusalReason::kBadGaussian:
      return "bad-gaussian";
    case RefusalReason::kBadMass:
      return "bad-mass";
    case RefusalReason::kStale:
      return "stale";
    case RefusalReason::kDuplicate:
      return "duplicate";
    case RefusalReason::kClockSkew:
      return "clock-skew";
    case RefusalReason::kForged:
      return "forged";
    case RefusalReason::kCount:
      break;
  }
  return "unknown";
}

std::uint64_t RefusalCounters::total() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

WireLimits wire_limits(const Mission& mission) {
  return {.robots = mission.robots.count,
          .bounds_m = mission.world.bounds_m(),
          .speed_max_mps = mission.robots.speed_max_mps,
          .clock_skew_warn = from_seconds(mission.timing.clock_skew_warn_s),
          .clock_skew_refuse = from_seconds(mission.timing.clock_skew_refuse_s)};
}

Checked<FlowPlan> check_plan(const PlanMessage& message, const WireLimits& limits) {
  if (message.schema_version != kSchemaVersion) return refuse(RefusalReason::kSchema);
  if (!fits_wire(message)) return refuse(RefusalReason::kOversized);
  std::vector<PlanNode> nodes;
  nodes.reserve(message.nodes.size());
  for (const auto& node : message.nodes) {
    if (const auto ok = check_node(node, limits); !ok) return refuse(ok.error());
    const auto gaussian = to_gaussian(node);
    if (!gaussian) return refuse(gaussian.error());
    nodes.push_back({.gaussian = *gaussian, .time = MissionTime(node.time_s), .mass = node.mass});
  }
  std::vector<PlanLeg> legs;
  legs.reserve(message.legs.size());
  for (const auto& leg : message.legs) {
    if (const auto ok = check_leg(leg, message.nodes); !ok) return refuse(ok.error());
    legs.push_back({.from = leg.from_node, .to = leg.to_node, .mass = leg.mass});
  }
  auto plan = FlowPlan::make(std::move(nodes), std::move(legs));
  if (!plan) return refuse(RefusalReason::kBadMass);  // all else was checked above
  if (!std::isfinite(message.excess_m)) return refuse(RefusalReason::kNotFinite);
  if (message.entries.size() > limits.robots) return refuse(RefusalReason::kOutOfRange);
  for (const PlanEntryMessage& entry : message.entries) {
    if (entry.source != kAnySource && entry.source >= plan->sources().size()) {
      return refuse(RefusalReason::kOutOfRange);
    }
  }
  return *std::move(plan);
}

Checked<void> check_heartbeat(const HeartbeatMessage& message) {
  if (message.schema_version != kSchemaVersion) return refuse(RefusalReason::kSchema);
  if (!all_finite(message.mission_time_s, message.plan_time_s, message.plan_rate)) {
    return refuse(RefusalReason::kNotFinite);
  }
  if (message.plan_rate < 0.0 || message.plan_rate > 1.0) return refuse(RefusalReason::kOutOfRange);
  if (!is_one_of_first(message.phase, MissionPhase::kStopped)) {
    return refuse(RefusalReason::kOutOfRange);
  }
  return {};
}

Checked<void> check_command(const CommandMessage& message) {
  if (message.schema_version != kSchemaVersion) return refuse(RefusalReason::kSchema);
  if (!is_one_of_first(message.kind, CommandKind::kStop)) {
    return refuse(RefusalReason::kOutOfRange);
  }
  return {};
}

Checked<void> check_status(const StatusMessage& message, const WireLimits& limits) {
  if (message.schema_version != kSchemaVersion) return refuse(RefusalReason::kSchema);
  if (!fits_wire(message)) return refuse(RefusalReason::kOversized);
  if (!std::isfinite(message.plan_time_s)) return refuse(RefusalReason::kNotFinite);
  for (const RobotStatusMessage& robot : message.robots) {
    if (!all_finite(robot.x_m, robot.y_m, robot.remaining_m, robot.lag_s, robot.nearest_gap_m)) {
      return refuse(RefusalReason::kNotFinite);
    }
    if (robot.robot_id >= limits.robots || !is_one_of_first(robot.mode, RobotMode::kStopped) ||
        !is_inside(robot.x_m, robot.y_m, limits)) {
      return refuse(RefusalReason::kOutOfRange);
    }
  }
  const bool bins_exist =
      std::all_of(message.state_age.begin(), message.state_age.end(),
                  [](const HistogramBinMessage& bin) { return bin.bin < Histogram::kBins; });
  if (!bins_exist) return refuse(RefusalReason::kOutOfRange);
  return {};
}

Checked<void> check_event(const EventMessage& message) {
  if (message.schema_version != kSchemaVersion) return refuse(RefusalReason::kSchema);
  if (message.code.size() > kMaxEventCode || message.text.size() > kMaxEventText) {
    return refuse(RefusalReason::kOversized);
  }
  if (!is_one_of_first(message.severity, Severity::kError) || !is_printable(message.code) ||
      !is_printable(message.text)) {
    return refuse(RefusalReason::kOutOfRange);
  }
  return {};
}

Checked<void> check_batch(const CellStatesMessage& message) {
  if (message.schema_version != kSchemaVersion) return refuse(RefusalReason::kSchema);
  if (!fits_wire(message)) return refuse(RefusalReason::kOversized);
  return {};
}

Checked<void> check_state(const RobotStateMessage& state, const WireLimits& limits, UtcTime now) {
  if (!all_finite(state.x_m, state.y_m, state.vx_mps, state.vy_mps)) {
    return refuse(RefusalReason::kNotFinite);
  }
  if (state.robot_id >= limits.robots || !is_one_of_first(state.mode, RobotMode::kStopped) ||
      !is_inside(state.x_m, state.y_m, limits) ||
      std::hypot(state.vx_mps, state.vy_mps) > 2.0 * limits.speed_max_mps) {
    return refuse(RefusalReason::kOutOfRange);
  }
  if (distance(now.time_since_epoch().count(), state.stamp_utc_ns) >
      limits.clock_skew_refuse.count()) {
    return refuse(RefusalReason::kClockSkew);
  }
  return {};
}

PlanMessage to_message(const FlowPlan& plan, PlannerEpoch epoch, PlanVersion version, UtcTime t0) {
  PlanMessage message{.version = version.value(),
                      .epoch = epoch.value(),
                      .t0_utc_ns = t0.time_since_epoch().count()};
  message.nodes.reserve(plan.nodes().size());
  for (const auto& node : plan.nodes()) {
    const auto& mean_m = node.gaussian.mean_m();
    const auto& covariance_m2 = node.gaussian.covariance_m2();
    message.nodes.push_back({.mean_x_m = mean_m.x(),
                             .mean_y_m = mean_m.y(),
                             .covariance_xx_m2 = covariance_m2(0, 0),
                             .covariance_xy_m2 = covariance_m2(0, 1),
                             .covariance_yy_m2 = covariance_m2(1, 1),
                             .time_s = node.time.count(),
                             .mass = node.mass});
  }
  message.legs.reserve(plan.legs().size());
  for (const auto& leg : plan.legs()) {
    message.legs.push_back({.from_node = leg.from, .to_node = leg.to, .mass = leg.mass});
  }
  return message;
}

bool PlanSequence::accept(std::uint64_t epoch, std::uint32_t version) {
  if (std::pair(epoch, version) <= std::pair(epoch_, version_)) return false;
  epoch_ = epoch;
  version_ = version;
  return true;
}

}  // namespace swarm::link
