// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/apf/diffusion_escape.hpp"

#include <algorithm>

namespace swarm::agent {
namespace {

// Largest factor by which repeated escapes spread farther.
constexpr double kWideningMax = 4.0;
constexpr double kEscapeReached = 1.0;  // radii from the target
constexpr double kRange = 10.0;     // range of the neighbours' repulsion in radii, as in the paper
constexpr double kStrength = 0.01;  // of that repulsion, per range²

}  // namespace

void DiffusionEscape::forget() {
  watching_ = false;
  target_m_.reset();
  widening_ = 1.0;
}

/// Virtual diffusion in the repulsion of neighbours alone: the path that the robot is stuck on has
/// no part in it.
Vec2 DiffusionEscape::diffuse(const ControlView& view, Rng& rng) const {
  const double range_m = kRange * options_->radius_m;
  const DiffusionPotential potential{
      .neighbours = view.neighbours,
      .repulsion = {.strength_m2 = kStrength * range_m * range_m, .range_m = range_m}};
  return virtual_diffusion(view.position_m, potential, view.world, true,
                           {.noise_mps05 = widening_ * options_->spread_m,
                            .time_s = 1.0,
                            .clearance_m = 1.1 * options_->radius_m},
                           rng);
}

[[gnu::hot]] std::optional<Vec2> DiffusionEscape::update(const ControlView& view, double progress_m,
                                                         bool wants_to_move, Rng& rng) {
  if (!wants_to_move) {
    forget();
    return std::nullopt;
  }
  // Progress ends the time stuck. Outside of an escape it also ends the widening.
  if (!watching_ || progress_m > best_progress_m_ + options_->progress_m) {
    if (!target_m_) widening_ = 1.0;
    watching_ = true;
    best_progress_m_ = progress_m;
    best_at_ = view.now;
  }
  // Under way to a target: until it is reached or time is up.
  if (target_m_) {
    const bool reached =
        (*target_m_ - view.position_m).norm() < kEscapeReached * options_->radius_m;
    if (!reached && view.now < until_) return target_m_;
    target_m_.reset();
    best_at_ = view.now;
  }
  if (view.now - best_at_ < options_->stuck_after) return std::nullopt;
  // Stuck. From here progress is measured anew, and the next escape spreads twice as far.
  target_m_ = diffuse(view, rng);
  until_ = view.now + options_->duration;
  best_progress_m_ = progress_m;
  widening_ = std::min(2.0 * widening_, kWideningMax);
  ++escapes_;
  return target_m_;
}

}  // namespace swarm::agent
