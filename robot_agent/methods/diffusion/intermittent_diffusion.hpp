// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "robot_agent/methods/apf/cotangent_repulsion.hpp"
#include "robot_agent/methods/apf/obstacle_repulsion.hpp"
#include "robot_agent/methods/shared/target_attraction.hpp"
#include "robot_agent/methods/shared/virtual_diffusion.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/shape_field.hpp"
#include "swarmflow/robot/control_method.hpp"

namespace swarm::agent {

/// The parameters of Alg. 1, and the shape to form.
struct IntermittentDiffusionOptions {
  std::shared_ptr<const ShapeField> shape;  ///< S; null: the goals' ellipses
  Mixture goal;                             ///< the mixture that `shape` was drawn for
  CotangentOptions repulsion;
  DiffusionOptions diffusion;  ///< time_s = 0: plain gradient descent
  ObstacleRepulsionOptions obstacles;
  double radius_m = 0.1;
  double tolerance_m2 = 0.05;  ///< of a robot's own F + G
  double gain_hz = 4.0;        ///< speed per gradient, where the step bound allows it
  double cruise_mps = 1.5;
  Duration period{};     ///< of control
  Duration flow_time{};  ///< longest time on (10) before diffusing, and on (14)
};

/// Shape formation by Alg. 1 of the intermittent-diffusion paper, every robot for itself:
///
///   (10)  x' = −k ∇(F + G)    until settled or for i_max steps; if F + G is within tolerance, stay
///   (11)  diffuse virtually from here to an intermediate target (virtual_diffusion.hpp)
///   (14)  x' = −k ∇(K + G)    towards it; then (10) again
///
/// The paper diffuses all robots together. Here only one whose own F + G stays above tolerance
/// does, after a random time, so that some robots leave a dense region and the others find room.
/// Under way it stays wherever F + G is within tolerance. Arrived robots stay on (10), so they
/// yield to robots that pass. Once (10) has run its time for them, g is smoothed at R, so that they
/// come to rest.
///
/// Step bound (Th. 6.3, h ≤ 1/L, here with a bound of its own for every robot): k·dt ≤ 1/Lᵢ with
/// Lᵢ = 2 + 2 Σⱼ g''(dᵢⱼ − 2s) and no step longer than s, a twentieth of the distance to the
/// nearest neighbour. A pair's Hessian [H −H; −H H] is at most diag(2H, 2H), so the Hessian of the
/// whole swarm's potential is at most diag(Lᵢ), and when all robots make such a step at once
/// V = ΣF + ½ΣG decreases. The corner of g at R alone may add to it, |G₀ cot θ| for a pair that
/// crosses R. Obstacles push in addition (obstacle_repulsion.hpp), and the safety filter may
/// shorten or turn a step.
class IntermittentDiffusion final : public ControlMethod {
 public:
  explicit IntermittentDiffusion(Shared<IntermittentDiffusionOptions> options);

  void set_goals(const FlowPlan& plan) override;
  void begin(const Route& route, const World& world) override;
  bool has_arrived(const ControlView& view) override;
  Vec2 desired_velocity(const ControlView& view, bool arrived, Rng& rng) override;
  Vec2 hold(const ControlView& view) override;
  /// The goal component of the largest weighted density.
  std::uint32_t goal(const Vec2& position_m) const override;
  double remaining_m() const override { return remaining_m_; }
  std::uint32_t escapes() const override { return diffusions_; }

  /// F + G at the last tick [m²].
  double energy_m2() const { return energy_m2_; }

 private:
  /// On (10) or on (14).
  enum class Phase { kShape, kTarget };
  /// The potentials at one tick, for has_arrived() and desired_velocity().
  struct NeighboursInRange {
    SteadyTime at;
    double reach_m = 0.0;
    Potential repulsion;  // G
    Potential shape;      // F
  };

  void weigh_goals();
  const NeighboursInRange& find_in_range(const ControlView& view);
  void enter(Phase phase, const ControlView& view, Rng& rng);
  void diffuse(const ControlView& view, Rng& rng);
  double reach_m(const ControlView& view) const;
  Vec2 descend(const Potential& potential, double reach_m) const;

  Shared<IntermittentDiffusionOptions> options_;
  std::shared_ptr<const ShapeField> shape_;
  std::vector<WeightedGaussian> goals_;
  std::vector<double> log_weights_;  // log of weight over √det Σ, for each goal
  Phase phase_ = Phase::kShape;
  bool begun_ = false;  // a phase is running
  SteadyTime until_;    // of the phase
  Target target_;
  std::optional<NeighboursInRange> in_range_;
  bool arrived_ = false;
  bool resting_ = false;  // arrived, and (10) has run its time
  double energy_m2_ = 0.0;
  double remaining_m_ = 0.0;
  std::uint32_t diffusions_ = 0;
};

/// The 90 % ellipses of a mixture as a shape, polygons of 32 corners.
ShapeField shape_of(const std::vector<WeightedGaussian>& components);

}  // namespace swarm::agent
