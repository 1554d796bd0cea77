// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "robot_agent/goal_watch.hpp"
#include "robot_agent/methods/apf/diffusion_escape.hpp"
#include "robot_agent/methods/apf/neighbour_repulsion.hpp"
#include "robot_agent/methods/apf/obstacle_repulsion.hpp"
#include "robot_agent/methods/shared/attraction.hpp"
#include "robot_agent/methods/shared/density_attraction.hpp"
#include "robot_agent/route/pace.hpp"
#include "robot_agent/route/pursuit.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarmflow/robot/control_method.hpp"

namespace swarm::agent {

/// The parameters of the method and of its terms.
struct ApfOptions {
  bool keeps_time = true;  ///< follows the plan's clock when there is one
  PursuitOptions pursuit;
  PaceOptions pace;
  DensityAttractionOptions density;
  NeighbourRepulsionOptions neighbour_repulsion;
  ObstacleRepulsionOptions obstacle_repulsion;
  EscapeOptions escape;
  double scale = 1.0;  ///< of the constants of the method (body_scale.hpp)
};

/// The artificial potential field of SwarmPRM and ROVER [SwarmPRM, eq. 14]:
///
///   u = −∂(w₁U_att + w₂U_rep)/∂x
///
/// U_att attracts to the aim point on the robot's own path through the flow (attraction.hpp), at
/// the pace that keeps the robot at its reference position x_ref(τ) of the plan's clock (pace.hpp),
/// and to the planned density (density_attraction.hpp). U_rep repels from neighbours and obstacles.
/// Where their sum has a local minimum and the robot is behind its reference, it escapes by
/// intermittent diffusion; a robot that waits because the plan does is not stuck.
///
/// | term                    | potential [m²/s]                    | on by default |
/// |-------------------------|-------------------------------------|---------------|
/// | attraction.hpp          | ∫₀^d v(s) ds                        | yes           |
/// | density_attraction.hpp  | p h (ρ̂ − ρ*)/(ρ̂ + ρ*)               | no            |
/// | neighbour_repulsion.hpp | Σⱼ ½ p d₀ (1 − gapⱼ/d₀)²             | yes           |
/// | obstacle_repulsion.hpp  | ½ p s₀ (1 − s/s₀)²                  | yes           |
class Apf final : public ControlMethod {
 public:
  explicit Apf(Shared<ApfOptions> options)
      : options_(std::move(options)), escape_(options_.part(&ApfOptions::escape)) {}

  void begin(const Route& route, const World& world) override;
  bool has_arrived(const ControlView& view) override;
  Vec2 desired_velocity(const ControlView& view, bool arrived, Rng& rng) override;
  Vec2 hold(const ControlView& view) override;
  std::optional<TimeTracking> tracking() const override;
  double lag_s() const override;
  std::uint32_t goal(const Vec2&) const override { return sink_; }
  double remaining_m() const override { return pursuit_.remaining_m(); }
  std::uint32_t escapes() const override { return escape_.escapes(); }

 private:
  Vec2 repulsion(const ControlView& view) const;
  Vec2 attraction_in_time(const ControlView& view, bool arrived, Rng& rng);
  Vec2 attraction_at_will(const ControlView& view, bool arrived, Rng& rng);
  Vec2 attraction_to_density(const ControlView& view, bool arrived) const;
  Vec2 attraction_to(const Vec2& escape_m, const ControlView& view) const;

  Shared<ApfOptions> options_;
  Pursuit pursuit_;
  Pace pace_;
  DiffusionEscape escape_;
  GoalWatch watch_;
  std::uint32_t sink_ = 0;
  /// The state of tracking at the last tick that kept the plan's time.
  struct InTime {
    PlanTime time;
    double reference_m = 0.0;  // arc length of its reference
    double at_m = 0.0;         // its own
  };
  std::optional<InTime> in_time_;
};

}  // namespace swarm::agent
