// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "swarm_core/base/ids.hpp"
#include "swarm_core/base/time.hpp"
#include "swarm_core/mission/mission.hpp"
#include "swarm_core/mission/scene.hpp"
#include "swarm_core/plan/flow_plan.hpp"
#include "swarm_core/world/world.hpp"
#include "swarm_link/messages.hpp"

/// The edge: nothing received is trusted. Each check is a pure function; what it refuses is counted
/// by reason and the last good value stays.
namespace swarm::link {

enum class RefusalReason : std::uint8_t {
  kUndecodable,  ///< bytes that are not a sample
  kSchema,       ///< unknown schema version
  kOversized,    ///< more elements than the contract allows
  kNotFinite,    ///< NaN or infinity
  kOutOfRange,   ///< id, enum, position or speed beyond its limits
  kBadGaussian,  ///< covariance not symmetric positive definite
  kBadMass,      ///< weights negative, over 1, not summing to 1, or not conserved
  kStale,        ///< older epoch, version, sequence number or stamp than what is known
  kDuplicate,    ///< seen before
  kClockSkew,    ///< stamp further from our clock than timing.clock_skew_refuse_s
  kForged,       ///< claims to be us, or somebody who cannot have sent it
  kCount
};

inline constexpr std::size_t kRefusalReasons = static_cast<std::size_t>(RefusalReason::kCount);

std::string_view to_string(RefusalReason reason);  ///< kebab-case, e.g. "not-finite"

/// Refusals so far, by reason.
class RefusalCounters {
 public:
  void count(RefusalReason reason, std::uint32_t times = 1) {
    counts_[static_cast<std::size_t>(reason)] += times;
  }
  std::uint32_t operator[](RefusalReason reason) const {
    return counts_[static_cast<std::size_t>(reason)];
  }
  const std::array<std::uint32_t, kRefusalReasons>& all() const { return counts_; }
  std::uint64_t total() const;

 private:
  std::array<std::uint32_t, kRefusalReasons> counts_{};
};

/// What a well-formed message may say in this mission.
struct WireLimits {
  std::uint32_t robots = 0;  ///< ids are below this
  Box bounds_m;              ///< positions lie inside, plus `bounds_slack_m`
  double bounds_slack_m = 5.0;
  double speed_max_mps = 1.5;  ///< speeds are at most twice this
  Duration clock_skew_warn{};
  Duration clock_skew_refuse{};
};

/// The limits of a mission.
WireLimits wire_limits(const Mission& mission);

template <class T>
using Checked = tl::expected<T, RefusalReason>;

/// PlanEntryMessage::source of a robot that may enter where it likes.
inline constexpr std::uint16_t kAnySource = 0xFFFF;

/// Schema, size and content of a plan (FlowPlan::make decides on Gaussians and masses; means must
/// lie inside the bounds plus slack; robots enter at sources there are).
Checked<FlowPlan> check_plan(const PlanMessage& message, const WireLimits& limits);

/// Schema, size and content of a scene: shapes are valid, obstacles in order, vertices all used,
/// bodies those of robots there are.
Checked<Scene> check_scene(const SceneMessage& message, const WireLimits& limits);

Checked<void> check_heartbeat(const HeartbeatMessage& message);
Checked<void> check_command(const CommandMessage& message);
Checked<void> check_status(const StatusMessage& message, const WireLimits& limits);
Checked<void> check_event(const EventMessage& message);

/// The frame of a batch: schema and number of states. The states are checked one by one.
Checked<void> check_batch(const CellStatesMessage& message);
Checked<void> check_state(const RobotStateMessage& state, const WireLimits& limits, UtcTime now);

PlanMessage to_message(const FlowPlan& plan, PlannerEpoch epoch, PlanVersion version, UtcTime t0);
SceneMessage to_message(const Scene& scene);

/// Sorts epochs and versions of plans and heartbeats: accepts what is newer than everything before.
class PlanSequence {
 public:
  /// Whether (epoch, version) is newer than the newest accepted; remembers it if so.
  bool accept(std::uint64_t epoch, std::uint32_t version);

 private:
  std::uint64_t epoch_ = 0;
  std::uint32_t version_ = 0;
};

}  // namespace swarm::link
