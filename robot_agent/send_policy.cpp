// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/send_policy.hpp"

#include <algorithm>

namespace swarm::agent {
namespace {

constexpr double kSendsNothingBelow_mps = 0.01;
constexpr double kOfGap = 0.2;          // tolerated error, as a share of the nearest gap
constexpr double kLeastError_m = 0.01;  // least tolerated error
constexpr double kNearGap_m = 0.5;      // nearer robots may rely on where this one comes to rest

}  // namespace

/// Dead reckoning with triggers in the order of their cost: first state, longest silence, a
/// follower about to brake, a near neighbour on a degraded link, error of the extrapolation.
[[gnu::hot]] bool SendPolicy::must_send(const SendInput& input) const {
  if (!last_) return true;
  const Duration silent = input.now - last_->now;
  if (silent >= options_->interval_max) return true;
  const double silent_s = to_seconds(silent);
  const double period_s = to_seconds(options_->period);
  // A follower brakes `timeout_s` after our last state. A state sent now takes `late_s` to arrive,
  // and the next chance to send is a period away: send while one of them still fits in.
  if (silent_s + std::max(period_s, input.link.late_s) > input.listeners.timeout_s) return true;
  const bool is_stopped = input.velocity_mps == last_->velocity_mps &&
                          input.velocity_mps.norm() < options_->scale * kSendsNothingBelow_mps;
  // Messages may be lost: near others every tick carries a state, except where nothing changes.
  if (input.link.poor && input.listeners.nearest_gap_m < options_->near_m && !is_stopped)
    return true;
  // Also the error of the extrapolation one period ahead: a robot that has just turned is off only
  // by then, and cannot publish in between. Near others two periods: if the process freezes now,
  // its body drives on until then, and nothing is published.
  const bool is_near = input.listeners.nearest_gap_m < options_->scale * kNearGap_m;
  const double ahead_s = is_near ? 2.0 * period_s : period_s;
  const Vec2 off_m = last_->position_m + silent_s * last_->velocity_mps - input.position_m;
  const Vec2 soon_off_m = off_m + ahead_s * (last_->velocity_mps - input.velocity_mps);
  // Where robots nearly touch, a few centimetres decide which of them may move.
  const double error_m =
      std::min(std::max(kOfGap * input.listeners.nearest_gap_m, options_->scale * kLeastError_m),
               options_->error_m);
  return std::max(off_m.norm(), soon_off_m.norm()) > error_m;
}

}  // namespace swarm::agent
