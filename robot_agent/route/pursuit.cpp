// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/route/pursuit.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "swarm_core/base/lanes.hpp"

namespace swarm::agent {
namespace {

constexpr double kStep_m = 0.25;    // step by which progress moves on
constexpr double kReached_m = 0.5;  // an aim this near counts as reached
// How far back along the path a visible point is looked for.
constexpr double kBackTrack_m = 30.0;
constexpr double kSample_m = 0.5;      // spacing of the samples of planned clearance
constexpr double kLeast_m = 0.05;      // surface clearance of any line of sight
constexpr double kTouch_m = 1e-3;      // tolerance at the robot's end of a line of sight
constexpr double kKeepAim_m = 1.5;     // an aim this far ahead is kept between two looks,
constexpr double kAtCarrot_m = 0.1;    // and one this near the carrot
constexpr double kLeastAhead_m = 0.1;  // nearer aims are no aims
constexpr double kBackStep_m = 1.0;    // step of the search back along the path

}  // namespace

/// Samples the clearance of the path once, so that looks only read it. Costs a distance query per
/// half metre.
Pursuit::Pursuit(Polyline path, const World& world, Shared<PursuitOptions> options)
    : path_(std::move(path)),
      options_(std::move(options)),
      segment_(path_.segment(0.0)),
      here_(segment_.position(0.0)) {
  const auto pieces = static_cast<std::size_t>(path_.length_m() / scaled(kSample_m)) + 1;
  clearance_m_.reserve(pieces);
  std::size_t segment = 0;
  for (std::size_t i = 0; i < pieces; ++i) clearance_m_.push_back(sample_m(i, world, segment));
}

/// Least clearance of a piece of the path, from its middle: the distance field has slope 1 at most,
/// so within half a piece the clearance is less by at most that half. `segment`: an index to search
/// from, set to the one found.
float Pursuit::sample_m(std::size_t piece, const World& world, std::size_t& segment) const {
  const double most_m = options_->radius_m + options_->keep_clearance_m;
  const double sample_m = scaled(kSample_m);
  const double s = (static_cast<double>(piece) + 0.5) * sample_m;
  const Polyline::Segment on = path_.segment(s, segment);
  segment = on.index;
  const double least_m = world.distance_m(on.position(s).point_m) - 0.5 * sample_m;
  return static_cast<float>(std::clamp(least_m, 0.0, most_m));
}

/// Samples the stretch ahead again; returns whether an obstacle has changed a clearance.
bool Pursuit::measure_ahead(const World& world) {
  const std::size_t last = piece_of(std::min(carrot_m_, s_m_ + options_->look_ahead_m));
  std::size_t segment = segment_.index;
  bool changed = false;
  for (std::size_t i = piece_of(s_m_); i <= last; ++i) {
    const float now_m = sample_m(i, world, segment);
    changed = changed || now_m != clearance_m_[i];
    clearance_m_[i] = now_m;
  }
  return changed;
}

std::size_t Pursuit::piece_of(double s_m) const {
  return std::min(clearance_m_.size() - 1, static_cast<std::size_t>(s_m / scaled(kSample_m)));
}

/// Least planned clearance between two arc lengths. O(pieces between them).
[[gnu::hot]] double Pursuit::planned_clearance_m(double from_s_m, double to_s_m) const {
  const float* const last = clearance_m_.data() + piece_of(to_s_m);
  const float* piece = clearance_m_.data() + piece_of(from_s_m);
  Float4 least_m = all(*piece);
  for (; last - piece >= kLanes; piece += kLanes) least_m = min(least_m, load(piece));
  for (; piece <= last; ++piece) least_m[0] = std::min(least_m[0], *piece);
  return static_cast<double>(
      std::min(std::min(least_m[0], least_m[1]), std::min(least_m[2], least_m[3])));
}

[[gnu::hot]] void Pursuit::move_to(double s_m) {
  s_m_ = s_m;
  if (!segment_.holds(s_m)) segment_ = path_.segment(s_m, segment_.index);
  here_ = segment_.position(s_m);
}

/// Moves progress on past all points that count as passed: nearer than passed_m, or beside the path
/// and behind the robot. An aim that was reached by a short cut is progress at once.
[[gnu::hot]] void Pursuit::advance(const Vec2& position_m) {
  if (aim_s_m_ > s_m_ && (aim_m_ - position_m).norm() < scaled(kReached_m)) move_to(aim_s_m_);
  const double length = path_.length_m();
  while (s_m_ < length) {
    const Vec2 offset = position_m - here_.point_m;
    const bool near = offset.norm() < options_->passed_m;
    // "Ahead of s along the tangent" means passed only near the path: where the path doubles back,
    // it holds at points far off, too.
    const bool beside = offset.norm() < options_->look_ahead_m && offset.dot(here_.tangent) > 0.0;
    if (!near && !beside) break;
    move_to(std::min(length, s_m_ + scaled(kStep_m)));
  }
}

/// Describes the present aim. Where progress has reached the aim before the path's end, past_m is
/// how far the robot is past the carrot along the tangent.
[[gnu::hot]] Pursuit::Aim Pursuit::aim(const Vec2& position_m) const {
  Aim aim{.point_m = aim_m_,
          .left_m = (aim_m_ - position_m).norm() + path_.length_m() - aim_s_m_,
          .rest_m = std::max(0.0, carrot_m_ - aim_s_m_),
          .visible = true};
  if (s_m_ >= aim_s_m_ && carrot_m_ < path_.length_m()) {
    const Vec2 tangent = path_.segment(aim_s_m_, segment_.index).position(aim_s_m_).tangent;
    aim.past_m = std::max(0.0, (position_m - aim_m_).dot(tangent) - aim.rest_m);
  }
  return aim;
}

/// Lines of sight are the cost of a pursuit: they are checked every look_every ticks only.
[[gnu::hot]] Pursuit::Aim Pursuit::update(const Vec2& position_m, const World& world,
                                          double carrot_m) {
  carrot_m_ = std::min(carrot_m, path_.length_m());
  advance(position_m);
  // Between two looks the last visible aim is kept, while it is well ahead or at the carrot.
  const bool is_kept = aim_s_m_ <= carrot_m_ && (aim_s_m_ - s_m_ > scaled(kKeepAim_m) ||
                                                 carrot_m_ - aim_s_m_ < scaled(kAtCarrot_m));
  if (looks_in_ > 0 && is_kept) {
    --looks_in_;
    return aim(position_m);
  }
  looks_in_ = options_->look_every;
  return look(position_m, world);
}

/// Halves the look-ahead until the point is visible; failing that, goes back along the path. A
/// robot that sees no point at all aims at its progress and looks again at the next tick.
Pursuit::Aim Pursuit::look(const Vec2& position_m, const World& world) {
  const double length = path_.length_m();
  const double most_m = options_->radius_m + std::max(scaled(kLeast_m), options_->keep_clearance_m);
  const double touch_m = scaled(kTouch_m);
  const double own_clearance =
      std::max(0.0, world.distance_up_to_m(position_m, most_m + touch_m) - touch_m);
  // As wide as the clearance planned for the stretch, but no wider than the room at the robot.
  const auto visible = [&](double s) {
    const double planned = planned_clearance_m(std::min(s_m_, s), std::max(s_m_, s));
    const double wanted = std::max(options_->radius_m + scaled(kLeast_m), planned);
    return world.segment_is_free(position_m, path_.at(s, segment_.index),
                                 std::min(wanted, own_clearance));
  };
  const auto aim_at = [&](double s) {
    aim_s_m_ = s;
    aim_m_ = path_.at(s, segment_.index);
    return aim(position_m);
  };
  const auto visible_ahead = [&]() -> std::optional<double> {
    for (double ahead = options_->look_ahead_m; ahead > scaled(kLeastAhead_m); ahead *= 0.5) {
      const double s = std::min(carrot_m_, s_m_ + ahead);
      if (visible(s)) return s;
      if (s <= s_m_) break;
    }
    return std::nullopt;
  };
  std::optional<double> s = visible_ahead();
  if (!s && measure_ahead(world)) s = visible_ahead();
  if (s) return aim_at(*s);
  for (double back = 0.0; back <= std::min(scaled(kBackTrack_m), s_m_);
       back += scaled(kBackStep_m)) {
    if (visible(s_m_ - back)) {
      move_to(s_m_ - back);
      return aim_at(s_m_);
    }
  }
  looks_in_ = 0;
  return {
      .point_m = here_.point_m, .left_m = length - s_m_, .rest_m = std::max(0.0, carrot_m_ - s_m_)};
}

}  // namespace swarm::agent
