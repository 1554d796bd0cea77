// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::agent {

/// The stuck test's and the walk's parameters.
struct EscapeWalkOptions {
  std::size_t window = 40;   ///< ℓ, in ticks
  double moved_min_m = 0.3;  ///< Δ_stuck
  std::size_t step = 15;     ///< ticks a random direction is kept
  double strength = 1.0;     ///< of the walk's first step
};

/// The stuck test and the random walk out of a local minimum [CRoPS, escaping local minima].
///
///   stuck(b) = 1 if ‖x(t) − x(t − ℓ)‖ < Δ_stuck, else 0
///   PF_escape = stuck(b) s min(n, 4) (r_x, r_y)      (r_x, r_y) the walk's n-th random direction
///
/// The code's robots make 1.5 m a tick and draw at every tick; ours make 0.15 m, so a direction is
/// kept for some ticks, which gives the walk steps as long as the code's. Steps grow while the
/// robot stays stuck, so that they outgrow a balance of the other fields. A walk ends with the
/// first step after which the robot is not stuck.
class EscapeWalk {
 public:
  explicit EscapeWalk(const EscapeWalkOptions& options);

  /// One tick; returns PF_escape. No allocation.
  Vec2 update(const Vec2& position_m, Rng& rng);

  /// Starts the stuck test anew (the robot was held, has arrived, has another path).
  void forget();

  bool is_stuck() const { return stuck_; }
  std::uint32_t escapes() const { return escapes_; }  ///< walks begun

 private:
  EscapeWalkOptions options_;
  std::vector<Vec2> past_m_;  // ring of the last ℓ positions
  std::size_t seen_ = 0;
  std::size_t next_ = 0;
  std::size_t step_left_ = 0;
  std::size_t steps_ = 0;  // of this walk
  Vec2 direction_ = Vec2::Zero();
  bool stuck_ = false;
  std::uint32_t escapes_ = 0;
};

}  // namespace swarm::agent
