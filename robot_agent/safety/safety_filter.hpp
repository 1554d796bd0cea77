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
/// What they guarantee, given speeds of at most v_max and commands that run out after 2Δt:
///
/// 1. A robot that begins with s ≥ m_o from every obstacle keeps it, however late its ticks are: an
///    obstacle is convex and lies within its half-plane, and u = 0 obeys all of them.
/// 2. Two robots that obey, begin with gap ≥ m and know each other to within e keep gap ≥ m − e
///    (with β = 0), however late their ticks are: a command closes at most γ (gap − m) in the 2Δt
///    it lasts, half of what is left above m for each, γ ≤ ½. With states that are τ old the pair
///    is the delayed system ẋ = −(γ/T) x(t − τ) for x = gap − m, which does not overshoot as long
///    as γτ/T ≤ 1/e: that is what a ≥ eγ is for. β, 0 for those with τ > 3.5 Δt, lets a
///    robot follow one that moves away, as far as what is given up when that one stops at once, β
///    v_max τ, is below 0.9 m.
/// 3. From a robot that keeps off no other, received at every tick and no faster than v_max, a
///    robot withdraws before contact: the second line asks for u at least as fast as the other
///    comes once the gap is down to a third of m. It is met whenever there is room to go to. One
///    whose body stopped while no state of it was received is not touched either: the third line
///    keeps a following robot off every position where it may have been left behind.
/// 4. No robot that may move freezes: where the lines have no common point, those that ask for a
///    wider gap are relaxed by the same least speed, down to not closing it, which u = 0 obeys. A
///    robot whose desired velocity is blocked by robots that face it turns it to its right, as all
///    robots do, so that opposing streams part into lanes.
///
/// λ = 0 for a body that has a commanded velocity at once. One that takes up to λ = v_max/a to
/// reach it is asked for no deceleration above a: towards an obstacle v/(2Δt + λ) < v/λ ≤ a, and of
/// two that close in on each other each 2γv/(2Δt + 2γλ) < a. Bodies that leave the commanded
/// direction (a unicycle while it turns, any with motion noise) may come as much nearer as they
/// leave it by, and the margins must hold that. The velocity that it publishes must then be the
/// measured one: β relies on it.
class SafetyFilter {
 public:
  SafetyFilter(const World& world, Shared<SafetyOptions> options);

  /// No allocation once warm. Cost: O(obstacles in reach + neighbours). `gives_way` allows the turn
  /// to the right: not where robots come to rest.
  Vec2 filter(const Vec2& position_m, const Vec2& desired_mps,
              std::span<const Neighbour> neighbours, bool gives_way = false) const;

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
  void collect_obstacles(const Vec2& position_m, Lines& lines) const;
  void collect_neighbours(const Vec2& position_m, std::span<const Neighbour> neighbours,
                          Lines& lines) const;
  std::optional<HalfPlane> off_possible_stop(const Vec2& position_m, const Neighbour& n,
                                             double sum_m) const;
  Vec2 nearest(const Vec2& desired_mps, Lines& lines) const;
  Vec2 least_violation(const Vec2& desired_mps, Lines& lines) const;

  const World& world_;
  Shared<SafetyOptions> options_;
  Pace fresh_;  // towards neighbours with fresh information
};

}  // namespace swarm::agent
