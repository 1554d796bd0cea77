// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "swarm_core/base/printable.hpp"
#include "swarm_core/base/stamp.hpp"
#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/gate/content_checks.hpp"
#include "swarm_link/gate/number_tests.hpp"
#include "swarm_link/wire_bounds.hpp"

namespace swarm::link {
namespace {

// Enumerations travel as octets; their values are consecutive from 0 to `last`.
template <class Enum>
bool is_one_of_first(Enum value, Enum last) {
  return static_cast<std::uint8_t>(value) <= static_cast<std::uint8_t>(last);
}

// |a − b|, saturating, because a received stamp may have any value.
std::int64_t distance(std::int64_t a, std::int64_t b) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(a, b, &difference)) return std::numeric_limits<std::int64_t>::max();
  if (difference == std::numeric_limits<std::int64_t>::min()) {
    return std::numeric_limits<std::int64_t>::max();
  }
  return std::abs(difference);
}

// A robot of a status: finite numbers, a robot of the mission, a position inside the bounds.
Checked<void> check_robot(const RobotStatusMessage& robot, const WireLimits& limits) {
  if (!all_finite(robot.x_m, robot.y_m, robot.remaining_m, robot.lag_s, robot.nearest_gap_m)) {
    return refuse(RefusalReason::kNotFinite);
  }
  if (robot.robot_id >= limits.robots || !is_one_of_first(robot.mode, RobotMode::kStopped) ||
      !is_inside(robot.x_m, robot.y_m, limits)) {
    return refuse(RefusalReason::kOutOfRange);
  }
  return {};
}

}  // namespace

// The order of the tests decides which reason is counted; NaN must be excluded before ranges.
Checked<void> check_heartbeat(const HeartbeatMessage& message) {
  if (message.schema_version != kSchemaVersion) return refuse(RefusalReason::kSchema);
  if (!all_finite(message.mission_time_s, message.plan_time_s, message.plan_rate)) {
    return refuse(RefusalReason::kNotFinite);
  }
  if (message.plan_rate < 0.0 || message.plan_rate > 1.0 || message.plan_time_s < 0.0 ||
      message.plan_time_s > kMaxPlanTime_s) {
    return refuse(RefusalReason::kOutOfRange);
  }
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
  if (message.first_robot_id >= limits.robots || message.plan_time_s < 0.0 ||
      message.plan_time_s > kMaxPlanTime_s) {
    return refuse(RefusalReason::kOutOfRange);
  }
  for (const RobotStatusMessage& robot : message.robots) {
    if (const auto ok = check_robot(robot, limits); !ok) return ok;
  }
  const bool bins_exist =
      std::all_of(message.state_age.begin(), message.state_age.end(),
                  [](const HistogramBinMessage& bin) { return bin.bin < Histogram::kBins; });
  if (!bins_exist) return refuse(RefusalReason::kOutOfRange);
  return {};
}

// Bounds are checked by hand, because fits_wire() covers sequences only and texts of other
// implementations may be longer.
Checked<void> check_event(const EventMessage& message, const WireLimits& limits) {
  if (message.schema_version != kSchemaVersion) return refuse(RefusalReason::kSchema);
  if (message.code.size() > kMaxEventCode || message.text.size() > kMaxEventText) {
    return refuse(RefusalReason::kOversized);
  }
  const bool known = message.source < limits.robots || message.source == kPlannerSource ||
                     message.source == kLauncherSource;
  if (!known || !is_one_of_first(message.severity, Severity::kError) ||
      !is_stamp(message.stamp_utc_ns) || !is_printable(message.code) ||
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

// Runs for every received state, so it must be cheap. Twice the speed limit is accepted: the check
// finds implausible values, it does not enforce limits.
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

}  // namespace swarm::link
