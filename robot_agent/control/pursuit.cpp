// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/control/pursuit.hpp"

#include <algorithm>
#include <utility>

namespace swarm::agent {
namespace {

constexpr double kStep_m = 0.25;    // of progress
constexpr double kReached_m = 0.5;  // an aim this near counts as reached
constexpr double kBackTrack_m = 30.0;

}  // namespace

Pursuit::Pursuit(Polyline path, const PursuitOptions& options)
    : path_(std::move(path)), options_(options) {}

void Pursuit::advance(const Vec2& position_m) {
  if (aim_s_m_ > s_m_ && (path_.at(aim_s_m_) - position_m).norm() < kReached_m) s_m_ = aim_s_m_;
  const double length = path_.length_m();
  while (s_m_ < length) {
    const Vec2 offset = position_m - path_.at(s_m_);
    const bool near = offset.norm() < options_.passed_m;
    // Only beside the way does "ahead of s" mean passed: a way that doubles back has points far off
    // whose tangents say the same.
    const bool beside =
        offset.norm() < options_.look_ahead_m && offset.dot(path_.tangent_at(s_m_)) > 0.0;
    if (!near && !beside) break;
    s_m_ = std::min(length, s_m_ + kStep_m);
  }
}

Pursuit::Aim Pursuit::update(const Vec2& position_m, const World& world) {
  const double length = path_.length_m();
  advance(position_m);
  const double own_clearance = world.distance_m(position_m) - 1e-3;
  const double clearance = std::min(options_.radius_m + 0.05, own_clearance);
  const auto visible = [&](double s) {
    return world.segment_is_free(position_m, path_.at(s), clearance);
  };
  const auto aim_at = [&](double s) {
    aim_s_m_ = s;
    const Vec2 point = path_.at(s);
    return Aim{point, (point - position_m).norm() + length - s, true};
  };
  for (double ahead = options_.look_ahead_m; ahead > 0.1; ahead *= 0.5) {
    const double s = std::min(length, s_m_ + ahead);
    if (visible(s)) return aim_at(s);
  }
  for (double back = 0.0; back <= std::min(kBackTrack_m, s_m_); back += 1.0) {
    if (visible(s_m_ - back)) {
      s_m_ -= back;
      return aim_at(s_m_);
    }
  }
  return {path_.at(s_m_), length - s_m_, false};
}

}  // namespace swarm::agent
