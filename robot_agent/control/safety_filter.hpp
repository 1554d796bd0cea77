// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "robot_agent/control/half_plane_qp.hpp"
#include "robot_agent/neighbour_table.hpp"
#include "swarm_core/world/world.hpp"

namespace swarm::agent {

struct SafetyOptions {
  double radius_m = 0.2;
  double speed_max_mps = 1.5;
  Duration period{};                 ///< of control
  double gap_share = 0.25;           ///< γ
  double neighbour_margin_m = 0.25;  ///< m
  double obstacle_margin_m = 0.05;   ///< m_o
  double follow_share = 0.5;         ///< β
};

/// The layer under every control method: the velocity nearest to the wished one that keeps its
/// promises.
///
///   neighbour j:  n_j·u ≤ γ (gap_j − m)/(2Δt) + β max(0, n_j·v_j)      n_j points to the neighbour
///   obstacle o:   n_o·u ≤ (s_o − m_o)/(2Δt) − max(0, −n_o·v_o)         n_o points into the
///   obstacle, v_o is its velocity
///   bounds:       the same with the four walls of the world
///
/// A command is valid for 2Δt, then the driver stops the robot. Hence: a robot that starts with
/// s_o ≥ m_o keeps it, however late its ticks are (an obstacle is convex and within its
/// half-plane). Two robots that start with gap ≥ m, know each other's position to within e and both
/// obey (with β = 0) keep a gap of m − e: each closes at most γ/1 of half of what is left above m.
/// β lets a robot follow one that moves away; what it gives up when that one stops at once, m − e
/// must hold: γ = 0.25, m = 0.25 m, β = 0.5 stand 150 ms and 20 % loss (tests). u = 0 obeys
/// everything while the gaps are above their margins; where one is below, the filter first asks for
/// what re-opens it and, if that has no solution, for not closing it: that always has one. It never
/// freezes what may move.
class SafetyFilter {
 public:
  SafetyFilter(const World& world, const SafetyOptions& options);

  /// No allocation once warm. Cost: O(obstacles in reach + neighbours).
  Vec2 filter(const Vec2& position_m, const Vec2& wish_mps, std::span<const Neighbour> neighbours);

 private:
  const World& world_;
  SafetyOptions options_;
  std::vector<HalfPlane> constraints_;
};

}  // namespace swarm::agent
