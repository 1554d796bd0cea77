// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "robot_agent/control/route.hpp"
#include "robot_agent/neighbour_table.hpp"
#include "swarm_core/base/shared.hpp"

namespace swarm::agent {

struct DensityAttractionOptions {
  double push_mps = 0.1;     ///< p; 0 = off
  double kernel_m = 2.0;     ///< h
  std::uint32_t robots = 1;  ///< N
};

/// The pull towards the planned density [m/s]: −∂U/∂x for the part of U_att [SwarmPRM, eq. 14;
/// ROVER's ref. 35] that compares the swarm with the mixture.
///
///   u = −p h ∇(ρ̂ − ρ*)(x) / (ρ̂ + ρ*)
///   ρ̂(x) = Σⱼ K(‖x − xⱼ‖)      K(d) = 3/(πh²) (1 − d²/h²)² for d < h: a kernel estimate from the
///                               neighbours heard, without a root or an exponential
///   ρ*(x) = N m 𝒩(x; μ, Σ)      the Gaussian of the robot's own leg at its own progress, m the
///                               leg's mass: the component of mixture(t) it is in
///
/// So robots leave crowds denser than planned for where there is to be more of them. O(neighbours).
class DensityAttraction {
 public:
  DensityAttraction() = default;
  DensityAttraction(std::span<const Station> stations, Shared<DensityAttractionOptions> options);

  Vec2 pull(const Vec2& position_m, double progress_m, std::span<const Neighbour> neighbours);

 private:
  void move_to(double progress_m);

  Shared<DensityAttractionOptions> options_;
  std::vector<Station> stations_;
  std::size_t leg_ = 0;         // of stations_
  double planned_at_m_ = -1.0;  // progress `planned_` is of
  Gaussian planned_;
  Mat2 precision_ = Mat2::Identity();  // its Σ⁻¹
  double planned_robots_ = 0.0;        // N m
};

}  // namespace swarm::agent
