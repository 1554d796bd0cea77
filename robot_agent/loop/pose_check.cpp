// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/loop/pose_check.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace swarm::agent {
namespace {

// Bodies overshoot their top speed, and periods vary.
constexpr double kSpeedShare = 1.5;
// Noise of this many standard deviations is no jump.
constexpr double kNoiseShare = 8.0;
constexpr double kLeastJump_m = 0.5;

/// Largest standard deviation along any axis: the root of the larger eigenvalue.
double largest_sigma_m(const Mat2& c) {
  const double mean = 0.5 * (c(0, 0) + c(1, 1));
  const double half = 0.5 * (c(0, 0) - c(1, 1));
  return std::sqrt(std::max(mean + std::hypot(half, 0.5 * (c(0, 1) + c(1, 0))), 0.0));
}

}  // namespace

PoseLimits PoseLimits::of(const BodySpec& body) {
  return {.timeout = from_seconds(body.pose_timeout_s),
          .sigma_max_m = body.pose_sigma_max_m,
          .speed_max_mps = body.speed_max_mps,
          .jump_m = kLeastJump_m + kNoiseShare * (body.motion_noise_m + body.position_noise_m)};
}

std::string pose_fault(const Measurement& measured, const PoseLimits& limits) {
  if (!measured.is_valid || !measured.position_m.allFinite()) return "the driver has no position";
  if (measured.age > limits.timeout) {
    return fmt::format("the position is older than {:g} s", to_seconds(limits.timeout));
  }
  if (measured.covariance_m2 && !(largest_sigma_m(*measured.covariance_m2) <= limits.sigma_max_m)) {
    return fmt::format("the position is uncertain by more than {:g} m", limits.sigma_max_m);
  }
  return {};
}

[[gnu::hot]] CheckedPose PoseCheck::check(const Measurement& measured, SteadyTime now) {
  CheckedPose pose{.position_m = measured.position_m, .why = pose_fault(measured, limits_)};
  const double most_mps = kSpeedShare * limits_.speed_max_mps;
  if (measured.velocity_mps && measured.velocity_mps->norm() <= most_mps) {
    pose.velocity_mps = measured.velocity_mps;
  }
  if (!pose.why.empty()) {
    if (!lost_since_) lost_since_ = now;
    newest_.reset();
    return pose;
  }
  const Place here{measured.position_m, now - std::max(Duration::zero(), measured.age)};
  if (!agrees(here, now)) {
    pose.why = "the position jumped or has just come back";
    return pose;
  }
  pose.is_valid = true;
  if (pose.velocity_mps) pose.position_m += to_seconds(now - here.at) * *pose.velocity_mps;
  return pose;
}

bool PoseCheck::is_reachable(const Place& from, const Place& to) const {
  const Duration between = std::max(Duration::zero(), to.at - from.at);
  const double most_m = limits_.jump_m + kSpeedShare * limits_.speed_max_mps * to_seconds(between);
  return (to.position_m - from.position_m).squaredNorm() <= most_m * most_m;
}

/// Whether a position counts by those before it.
[[gnu::hot]] bool PoseCheck::agrees(const Place& here, SteadyTime now) {
  const bool was_lost = lost_since_ && now - *lost_since_ > limits_.timeout;
  if (trusted_ && (was_lost || !is_reachable(*trusted_, here))) {
    if (!lost_since_) lost_since_ = now - limits_.timeout;
    if (!newest_ || !is_reachable(*newest_, here)) agree_since_ = now;
    newest_ = here;
    if (now - agree_since_ < kAgreeFor) return false;
  }
  newest_.reset();
  lost_since_.reset();
  trusted_ = here;
  return true;
}

}  // namespace swarm::agent
