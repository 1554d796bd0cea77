// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/crops/fields/escape_walk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace swarm::agent {
namespace {

// The walk's steps grow up to this multiple of the first.
constexpr std::size_t kStrongest = 4;

}  // namespace

EscapeWalk::EscapeWalk(const EscapeWalkOptions& options)
    : options_(options), past_m_(std::max<std::size_t>(1, options.window), Vec2::Zero()) {}

void EscapeWalk::forget() {
  seen_ = 0;
  step_left_ = 0;
  stuck_ = false;
}

/// The ring past_m_ holds the last ℓ positions; next_ is the oldest, the one to compare with. A
/// direction is kept for `step` ticks, also if the robot comes free meanwhile.
Vec2 EscapeWalk::update(const Vec2& position_m, Rng& rng) {
  const bool was_stuck = stuck_;
  stuck_ = seen_ >= past_m_.size() && (position_m - past_m_[next_]).norm() < options_.moved_min_m;
  past_m_[next_] = position_m;
  next_ = (next_ + 1) % past_m_.size();
  seen_ = std::min(seen_ + 1, past_m_.size());

  if (step_left_ > 0) {
    --step_left_;
  } else if (stuck_) {
    const double angle_rad = uniform(rng, -std::numbers::pi, std::numbers::pi);
    steps_ = was_stuck ? std::min(steps_ + 1, kStrongest) : 1;
    direction_ = options_.strength * static_cast<double>(steps_) *
                 Vec2(std::cos(angle_rad), std::sin(angle_rad));
    step_left_ = options_.step - 1;
    if (!was_stuck) ++escapes_;
  } else {
    direction_ = Vec2::Zero();
  }
  return direction_;
}

}  // namespace swarm::agent
