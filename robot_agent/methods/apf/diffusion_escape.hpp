// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "robot_agent/methods/shared/virtual_diffusion.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarmflow/robot/control_method.hpp"

namespace swarm::agent {

/// When a robot counts as stuck, and how far it escapes.
struct EscapeOptions {
  double progress_m = 0.3;  ///< a robot with less progress along its path in stuck_after is stuck
  Duration stuck_after{};   ///< time over which progress is measured
  Duration duration{};      ///< longest time under way to an intermediate target
  double spread_m = 4.0;    ///< largest standard deviation per axis of the targets
  double radius_m = 0.2;
};

/// Frees a robot from a local minimum of whatever it follows, by one period of intermittent
/// diffusion: gradient flow alone until the robot is stuck, then a virtual diffusion from its
/// position to an intermediate target in line of sight (virtual_diffusion.hpp), flow (14) towards
/// it until it is reached or time is up, then gradient flow again. An escape that gained nothing is
/// followed by one that spreads twice as far, up to four times.
class DiffusionEscape {
 public:
  explicit DiffusionEscape(Shared<EscapeOptions> options) : options_(std::move(options)) {}

  /// The target to go to instead of following the path; empty unless the robot is escaping.
  /// `progress_m` grows along the path. `wants_to_move` false (waiting, arrived) resets the state.
  std::optional<Vec2> update(const ControlView& view, double progress_m, bool wants_to_move,
                             Rng& rng);

  /// Resets the state, as when the path is replaced: progress on different paths is not comparable.
  void forget();

  std::uint32_t escapes() const { return escapes_; }

 private:
  Vec2 diffuse(const ControlView& view, Rng& rng) const;

  Shared<EscapeOptions> options_;
  bool watching_ = false;
  double best_progress_m_ = 0.0;
  SteadyTime best_at_;
  std::optional<Vec2> target_m_;
  SteadyTime until_;
  double widening_ = 1.0;
  std::uint32_t escapes_ = 0;
};

}  // namespace swarm::agent
