// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "robot_agent/neighbours/neighbour_table.hpp"
#include "robot_agent/safety/half_plane_qp.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::agent {

/// The parameters of the filter, with the symbols of the formulas at SafetyFilter.
struct SafetyOptions {
  double radius_m = 0.2;
  double speed_max_mps = 1.5;
  Duration period{};                 ///< Δt, of control
  double lag_s = 0.0;                ///< λ: until the body has reached a commanded velocity
  double gap_share = 0.5;            ///< γ
  double stale_gain = 1.0;           ///< a
  double neighbour_margin_m = 0.25;  ///< m
  double obstacle_margin_m = 0.05;   ///< m_o
  double follow_share = 0.8;         ///< β
  double scale = 1.0;  ///< of the least desired speed that is worth a turn (body_scale.hpp)
};

/// What a robot means to the neighbours that receive its states.
struct Listeners {
  double nearest_gap_m = std::numeric_limits<double>::infinity();  ///< surface to surface
  /// Time without a state update of this robot after which a following neighbour brakes, because
  /// the robot may have stopped.
  double timeout_s = 1e9;
};

/// The layer under every control method: returns the velocity nearest to the desired one that keeps
/// the following bounds.
///
///   neighbour j:  n·u ≤ γ (gap − m) / (2T) + β max(0, n·v_j),   T = Δt + γλ + a max(0, τ_j − Δt)
///                 n·u ≤ (gap − m/3) / (2Δt + λ) − max(0, −n·v_j)
///                 n·u ≤ max(0, (gap_s − m/3) / (2Δt + λ))
///   obstacle o:   n·u ≤ (s − m_o) / (2Δt + λ) − max(0, −n·v_o)
///   bounds:       the same with the four walls of the world
///
/// n points to the neighbour, or into the obstacle; v_j is the velocity that the neighbour
/// published; gap_s, and its n, are to where it is if it stopped after its last state update.
///
/// The bounds guarantee, given speeds of at most v_max and commands that run out after 2Δt:
///
/// 1. A robot that begins with s ≥ m_o from every obstacle keeps it, however late its ticks are: an
///    obstacle is convex and lies within its half-plane, and u = 0 obeys all these half-planes.
/// 2. Two robots that obey, begin with gap ≥ m and know each other's position to within ε keep
///    gap ≥ m − ε (with β = 0), however late their ticks are: a command lasts 2Δt and closes at
///    most γ (gap − m) in that time; with γ ≤ ½ each robot uses at most half of the gap above m.
///    With states that are τ old, x = gap − m obeys the delayed equation ẋ = −(γ/T) x(t − τ), which
///    does not overshoot as long as γτ/T ≤ 1/e (e: Euler's number); a ≥ eγ ensures that. β lets a
///    robot follow one that moves away; it is 0 for neighbours with τ > 3.5 Δt. If that neighbour
///    stops at once, following costs at most β v_max τ of the gap, which is below 0.9 m.
/// 3. If the other robot does not avoid anyone, but is received every tick and is no faster than
///    v_max, this robot backs away before contact: once the gap is below a third of m, the second
///    line demands a retreat as fast as the other approaches. This is possible while there is free
///    space to retreat to. A robot that stopped unnoticed is not touched: the third line keeps
///    clear of every place where it may have stopped.
/// 4. No robot that may move freezes. If no velocity meets all lines, those that demand a widening
///    gap are relaxed equally, as little as possible, at most to "do not close". u = 0 then always
///    qualifies. Where the disc of a silent robot bounds it, first only those of discs and of
///    robots that may have stopped unnoticed; if that does not suffice, those of discs alone, as
///    far as needed; then all. A robot whose desired velocity is blocked by robots that face it
///    turns it to its right, as all robots do, so that opposing streams part into lanes.
///
/// λ = 0 for a body that has a commanded velocity at once. A body whose acceleration is limited to
/// A takes up to λ = v_max/A to reach it, and the lines never demand a deceleration above A:
/// towards an obstacle they demand v/(2Δt + λ) < v/λ ≤ A, and of each of two robots that approach
/// each other 2γv/(2Δt + 2γλ) < A. A body that deviates from the commanded direction (a unicycle
/// while it turns, any body with motion noise) may come nearer by the deviation; the margins must
/// cover it. Such a body must publish its measured velocity: β relies on it.
class SafetyFilter {
 public:
  SafetyFilter(const World& world, Shared<SafetyOptions> options);

  /// Discs of silent robots are the last of `neighbours`.
  /// No allocation once warm. Cost: O(obstacles in reach + neighbours). `gives_way` allows the turn
  /// to the right: not where robots come to rest.
  Vec2 filter(const Vec2& position_m, const Vec2& desired_mps,
              std::span<const Neighbour> neighbours, bool gives_way = false) const;

  /// For a robot that must not move of its own (SilentRobots): the velocity nearest to zero that
  /// keeps off approaching obstacles, and off neighbours that approach by a state no older than a
  /// command lasts. An obstacle at rest moves no robot, not even one inside its margin: it may be a
  /// circle that is much wider than the body of the silent robot in it.
  /// Towards robots that receive it and obey it is zero: they close at most at γ (gap − m) / (2T),
  /// for which the second line leaves room. O(obstacles in reach + neighbours).
  Vec2 stand(const Vec2& position_m, std::span<const Neighbour> neighbours) const;

  /// What a robot at `position_m` with `velocity_mps` means to `neighbours`. O(neighbours).
  Listeners listeners(const Vec2& position_m, const Vec2& velocity_mps,
                      std::span<const Neighbour> neighbours) const;

 private:
  /// How fast a gap may close, by the age of the information.
  struct Pace {
    double closing_hz;  ///< γ / (2T)
    double follow;      ///< β
  };
  Pace pace(double information_age_s) const;
  struct Lines;
  static Lines& empty_lines();  // of the calling thread
  void collect_obstacles(const Vec2& position_m, Lines& lines, bool stands) const;
  void collect_neighbours(const Vec2& position_m, std::span<const Neighbour> neighbours,
                          Lines& lines) const;
  void collect_approaching(const Vec2& position_m, std::span<const Neighbour> neighbours,
                           Lines& lines) const;
  std::optional<HalfPlane> off_possible_stop(const Vec2& position_m, const Neighbour& n,
                                             double sum_m) const;
  std::size_t collect_uncertain_last(const Vec2& position_m, std::span<const Neighbour> neighbours,
                                     Lines& lines) const;
  Vec2 nearest_relaxed(const Vec2& position_m, const Vec2& desired_mps,
                       std::span<const Neighbour> neighbours, Lines& lines) const;
  std::optional<Vec2> least_violation(const Vec2& desired_mps, std::size_t first, bool closing,
                                      Lines& lines) const;

  const World& world_;
  Shared<SafetyOptions> options_;
  Pace fresh_;  // towards neighbours with fresh information
};

}  // namespace swarm::agent
