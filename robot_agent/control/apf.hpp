// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "robot_agent/control/attraction.hpp"
#include "robot_agent/control/control_method.hpp"
#include "robot_agent/control/density_attraction.hpp"
#include "robot_agent/control/diffusion_escape.hpp"
#include "robot_agent/control/neighbour_repulsion.hpp"
#include "robot_agent/control/obstacle_repulsion.hpp"
#include "robot_agent/control/pursuit.hpp"
#include "robot_agent/goal_watch.hpp"
#include "swarm_core/base/shared.hpp"

namespace swarm::agent {

struct ApfOptions {
  PursuitOptions pursuit;
  AttractionOptions attraction;
  DensityAttractionOptions density;
  NeighbourRepulsionOptions neighbour_repulsion;
  ObstacleRepulsionOptions obstacle_repulsion;
  EscapeOptions escape;
};

/// The artificial potential field of SwarmPRM and ROVER [SwarmPRM, eq. 14]:
///
///   u = −∂(w₁U_att + w₂U_rep)/∂x
///
/// with flow tracking (pursuit of the own way, attraction.hpp) and the pull towards the planned
/// density (density_attraction.hpp) for U_att, neighbours and obstacles for U_rep, and
/// intermittent diffusion where the sum of them has a local minimum.
class Apf final : public ControlMethod {
 public:
  explicit Apf(Shared<ApfOptions> options)
      : options_(std::move(options)), escape_(options_.part(&ApfOptions::escape)) {}

  void begin(const Route& route, const World& world) override;
  bool has_arrived(const ControlView& view) override;
  Vec2 wish(const ControlView& view, bool arrived, Rng& rng) override;
  Vec2 hold(const ControlView& view) override;
  std::uint32_t goal(const Vec2&) const override { return sink_; }
  double remaining_m() const override { return pursuit_.remaining_m(); }
  std::uint32_t escapes() const override { return escape_.escapes(); }

 private:
  Vec2 repulsion(const ControlView& view) const;

  Shared<ApfOptions> options_;
  Pursuit pursuit_;
  DensityAttraction density_;
  DiffusionEscape escape_;
  GoalWatch watch_;
  std::uint32_t sink_ = 0;
};

}  // namespace swarm::agent
