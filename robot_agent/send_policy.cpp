// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/send_policy.hpp"

#include <algorithm>

namespace swarm::agent {
namespace {

constexpr double kSendsNothingBelow_mps = 0.01;
constexpr double kOfGap = 0.2;          // an error of this share of the nearest gap matters
constexpr double kLeastError_m = 0.01;  // and of less than this never

}  // namespace

bool SendPolicy::must_send(const SendInput& input) const {
  if (!last_) return true;
  const Duration silent = input.now - last_->now;
  if (silent >= options_->interval_max) return true;
  const double silent_s = to_seconds(silent);
  const double period_s = to_seconds(options_->period);
  // What is published now is used when it was received; until then they have the last state update.
  if (silent_s + std::max(period_s, input.link.late_s) > input.listeners.timeout_s) return true;
  const bool is_stopped =
      input.velocity_mps == last_->velocity_mps && input.velocity_mps.norm() < kSendsNothingBelow_mps;
  if (input.link.poor && input.listeners.nearest_gap_m < options_->near_m && !is_stopped) return true;
  // Whoever turns only now will be where nobody expects it before it can speak again.
  const Vec2 off_m = last_->position_m + silent_s * last_->velocity_mps - input.position_m;
  const Vec2 soon_off_m = off_m + period_s * (last_->velocity_mps - input.velocity_mps);
  // Where robots touch each other almost, a few centimetres decide who may move.
  const double error_m =
      std::min(std::max(kOfGap * input.listeners.nearest_gap_m, kLeastError_m), options_->error_m);
  return std::max(off_m.norm(), soon_off_m.norm()) > error_m;
}

}  // namespace swarm::agent
