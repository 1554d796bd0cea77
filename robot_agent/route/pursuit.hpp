// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "swarm_core/base/shared.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/robot/polyline.hpp"

namespace swarm::agent {

/// How far a pursuit looks ahead, and how wide.
struct PursuitOptions {
  double look_ahead_m = 12.0;
  double radius_m = 0.2;
  double passed_m = 0.7;          ///< a point of the path this near counts as passed
  double keep_clearance_m = 2.0;  ///< planned surface clearance up to this is kept by short cuts
  std::uint32_t look_every = 5;   ///< ticks between two looks for a farther aim
  double scale = 1.0;             ///< of the constants of the pursuit (body_scale.hpp)
};

/// Follows a path up to a carrot on it: progress s moves on when the robot has passed the point at
/// s, and the aim is the farthest of s + L, s + L/2, s + L/4 … before the carrot that is in line of
/// sight. If even s is hidden (the robot was pushed around a corner), the aim falls back along the
/// path to the last visible point.
///
/// A short cut keeps the risk that was planned: its line of sight is as wide as the smallest
/// clearance of the stretch of path it replaces (up to keep_clearance_m), so a robot never gets
/// nearer to an obstacle than its own path does there, and short cuts are taken where there is
/// room. Where no point ahead is in sight, an obstacle may have come nearer to the path: then the
/// clearance of the stretch ahead is measured anew.
class Pursuit {
 public:
  Pursuit() = default;
  Pursuit(Polyline path, const World& world, Shared<PursuitOptions> options);

  /// The point to head for, and what is left of the path.
  struct Aim {
    Vec2 point_m = Vec2::Zero();
    double left_m = 0.0;  ///< of the path: straight to the aim, from there along it to its end
    double rest_m = 0.0;  ///< of it from the aim to the carrot
    double past_m = 0.0;  ///< > 0: the robot is past the carrot by this distance
    bool visible = false;
  };

  /// Moves progress on and picks the aim, no farther than the carrot at the arc length `carrot_m`;
  /// by default the end of the path. No allocation.
  Aim update(const Vec2& position_m, const World& world,
             double carrot_m = std::numeric_limits<double>::infinity());

  double progress_m() const { return s_m_; }
  double remaining_m() const { return path_.length_m() - s_m_; }
  double length_m() const { return path_.length_m(); }
  Vec2 end_m() const { return path_.vertices_m().back(); }
  /// The point at an arc length.
  Vec2 point_m(double s_m) const { return path_.at(s_m, segment_.index); }

 private:
  std::size_t piece_of(double s_m) const;
  void move_to(double s_m);
  void advance(const Vec2& position_m);
  Aim aim(const Vec2& position_m) const;
  Aim look(const Vec2& position_m, const World& world);
  double planned_clearance_m(double from_s_m, double to_s_m) const;
  float sample_m(std::size_t piece, const World& world, std::size_t& segment) const;
  bool measure_ahead(const World& world);
  double scaled(double length_m) const { return options_->scale * length_m; }

  Polyline path_;
  Shared<PursuitOptions> options_;
  double s_m_ = 0.0;
  Polyline::Segment segment_;  // the one s_m_ is on, kept here as the path is far off in memory
  Polyline::Position here_;    // at s_m_
  double carrot_m_ = 0.0;      // of the last update
  double aim_s_m_ = 0.0;       // of the last visible aim
  Vec2 aim_m_ = Vec2::Zero();
  std::uint32_t looks_in_ = 0;      // ticks until the next look
  std::vector<float> clearance_m_;  // least clearance of each piece of kSample_m of the path
};

}  // namespace swarm::agent
