// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/control/diffusion_kick.hpp"

namespace swarm::agent {

Vec2 DiffusionKick::update(SteadyTime now, double progress_m, bool wants_to_move, Rng& rng) {
  if (!wants_to_move) {
    watching_ = false;
    return Vec2::Zero();
  }
  if (!watching_ || progress_m > best_progress_m_ + options_.progress_m) {
    watching_ = true;
    best_progress_m_ = progress_m;
    best_at_ = now;
  }
  if (now < kick_until_) return kick_mps_;
  if (now - best_at_ < options_.stuck_after) return Vec2::Zero();
  kick_mps_ = options_.velocity_mps * Vec2(standard_normal(rng), standard_normal(rng));
  kick_until_ = now + options_.duration;
  best_at_ = kick_until_;
  best_progress_m_ = progress_m;
  ++kicks_;
  return kick_mps_;
}

}  // namespace swarm::agent
