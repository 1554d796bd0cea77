// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/robot/driver.hpp"

namespace swarm::agent {

/// What a measured position must keep to be used.
struct PoseLimits {
  Duration timeout{};        ///< oldest position
  double sigma_max_m = 0.0;  ///< largest standard deviation along any axis
  double speed_max_mps = 0.0;
  /// A position further from the last one than the body can have moved, and than this, is a jump.
  double jump_m = 0.0;

  static PoseLimits of(const BodySpec& body);
};

/// The position of a robot at one tick.
struct CheckedPose {
  bool is_valid = false;
  Vec2 position_m = Vec2::Zero();  ///< moved on to the tick with the measured velocity
  /// As measured, if that is finite and not faster than the body can be.
  std::optional<Vec2> velocity_mps{};
  std::string why{};  ///< without a position: the reason, one line
};

/// Why a measurement alone is no position: invalid, not finite, old or imprecise; empty if it is
/// one.
std::string pose_fault(const Measurement& measured, const PoseLimits& limits);

/// Decides whether a robot knows where it is. A position counts that the driver calls valid, that
/// is finite, recent and precise, and not further from the last one than the body can have moved.
/// Localisation that jumps by metres is wrong before or after: after a jump, and after a loss of
/// more than the timeout, positions must agree with each other for kAgreeFor before they count.
/// Allocates only for `why`. One thread at a time.
class PoseCheck {
 public:
  static constexpr Duration kAgreeFor = std::chrono::seconds(1);

  explicit PoseCheck(const PoseLimits& limits) : limits_(limits) {}

  CheckedPose check(const Measurement& measured, SteadyTime now);

 private:
  /// A position and when the body was there.
  struct Place {
    Vec2 position_m = Vec2::Zero();
    SteadyTime at;
  };
  bool is_reachable(const Place& from, const Place& to) const;
  bool agrees(const Place& here, SteadyTime now);

  PoseLimits limits_;
  std::optional<Place> trusted_{};          ///< the last position that counted
  std::optional<SteadyTime> lost_since_{};  ///< since when there has been none
  std::optional<Place> newest_{};           ///< the last one that is waiting for others to agree
  SteadyTime agree_since_;
};

}  // namespace swarm::agent
