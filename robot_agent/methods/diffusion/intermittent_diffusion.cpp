// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/diffusion/intermittent_diffusion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robot_agent/methods/shared/shape_attraction.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::agent {
namespace {

constexpr double kChiSquared2Dof90 = 4.605170185988091;
constexpr double kReachShare = 0.05;  // s, longest step, of the distance to the nearest neighbour
constexpr double kArrive = 0.99;      // of the tolerance, to arrive; all of it to stay arrived
constexpr double kFadeAtRest = 0.1;   // of the range, see CotangentOptions
constexpr double kRoom = 0.9;         // of the tolerance: here a robot under way to a target stays
constexpr double kTargetReached = 1.0;  // radii from the target

/// Whether a mixture has a component with this mean.
bool is_goal_of(const Mixture& mixture, const Gaussian& g) {
  constexpr double kSame_m = 1e-6;
  return std::any_of(mixture.components().begin(), mixture.components().end(), [&](const auto& c) {
    return (c.gaussian.mean_m() - g.mean_m()).norm() < kSame_m;
  });
}

}  // namespace

/// Polygons of the ellipses μ + √χ²₂(0.9) L (cos φ, sin φ), with L the Cholesky factor of Σ.
ShapeField shape_of(const std::vector<WeightedGaussian>& components) {
  constexpr int kCorners = 32;
  std::vector<Polygon> ellipses;
  for (const WeightedGaussian& c : components) {
    const Mat2 root = std::sqrt(kChiSquared2Dof90) * cholesky_lower(c.gaussian.covariance_m2());
    std::vector<Vec2> corners;
    for (int i = 0; i < kCorners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kCorners;
      corners.emplace_back(c.gaussian.mean_m() + root * Vec2(std::cos(angle), std::sin(angle)));
    }
    if (auto polygon = Polygon::make(std::move(corners))) ellipses.push_back(*std::move(polygon));
  }
  auto shape = ShapeField::make(std::move(ellipses));
  SWARM_ASSERT(shape.has_value());
  return *std::move(shape);
}

IntermittentDiffusion::IntermittentDiffusion(Shared<IntermittentDiffusionOptions> options)
    : options_(std::move(options)), shape_(options_->shape) {}

void IntermittentDiffusion::set_goals(const FlowPlan& plan) {
  goals_.clear();
  bool drawn = options_->shape != nullptr;
  for (const std::uint32_t sink : plan.sinks()) {
    const PlanNode& node = plan.nodes()[sink];
    goals_.push_back({node.mass, node.gaussian});
    drawn = drawn && is_goal_of(options_->goal, node.gaussian);
  }
  // The drawn shape belongs to the mission's goal. A goal set later has only its mixture: then the
  // ellipses of that are the shape.
  shape_ = drawn ? options_->shape : std::make_shared<const ShapeField>(shape_of(goals_));
  weigh_goals();
}

/// log(w/√det Σ) of each goal component. As logarithms, densities differ even far from all goals,
/// where they underflow to 0.
void IntermittentDiffusion::weigh_goals() {
  log_weights_.clear();
  for (const WeightedGaussian& g : goals_) {
    log_weights_.push_back(std::log(g.weight) - 0.5 * std::log(g.gaussian.determinant()));
  }
}

void IntermittentDiffusion::begin(const Route& route, const World&) {
  if (goals_.empty()) {
    goals_.push_back({1.0, route.goal});
    weigh_goals();
  }
  if (shape_ == nullptr) shape_ = std::make_shared<const ShapeField>(shape_of(goals_));
  begun_ = false;
  resting_ = false;
  in_range_.reset();
  arrived_ = false;
}

std::uint32_t IntermittentDiffusion::goal(const Vec2& position_m) const {
  std::size_t best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < goals_.size(); ++i) {
    const double log_density =
        log_weights_[i] - 0.5 * goals_[i].gaussian.mahalanobis_squared(position_m);
    if (log_density <= most) continue;
    most = log_density;
    best = i;
  }
  return static_cast<std::uint32_t>(best);
}

/// The longest step s of this tick: for the bound of curvature, no pair comes nearer than 0.9 of
/// its distance if both make it.
double IntermittentDiffusion::reach_m(const ControlView& view) const {
  double nearest_squared = options_->repulsion.range_m * options_->repulsion.range_m;
  for (const Neighbour& n : view.neighbours) {
    nearest_squared = std::min(nearest_squared, (n.position_m - view.position_m).squaredNorm());
  }
  return kReachShare * std::sqrt(nearest_squared);
}

/// F and G at this tick; computed once, as has_arrived() and desired_velocity() both need them.
const IntermittentDiffusion::NeighboursInRange& IntermittentDiffusion::find_in_range(
    const ControlView& view) {
  if (in_range_ && in_range_->at == view.now) return *in_range_;
  const double reach = reach_m(view);
  CotangentOptions repulsion = options_->repulsion;
  if (resting_) repulsion.fade_share = kFadeAtRest;
  in_range_ = {view.now, reach,
               cotangent_repulsion(view.position_m, view.neighbours, repulsion, reach),
               shape_attraction(view.position_m, *shape_)};
  energy_m2_ = in_range_->repulsion.energy_m2 + in_range_->shape.energy_m2;
  arrived_ = energy_m2_ <= (arrived_ ? 1.0 : kArrive) * options_->tolerance_m2;
  return *in_range_;
}

/// Velocity −k∇V with k·Δt ≤ 1/L (Th. 6.3), no faster than cruise speed and no farther than s in a
/// control period.
Vec2 IntermittentDiffusion::descend(const Potential& potential, double reach_m) const {
  const double period_s = to_seconds(options_->period);
  const double gain_hz = std::min(options_->gain_hz, 1.0 / (potential.curvature * period_s));
  const Vec2 desired_mps = -gain_hz * potential.gradient_m;
  const double limit_mps = std::min(options_->cruise_mps, reach_m / period_s);
  const double speed_mps = desired_mps.norm();
  return speed_mps > limit_mps ? Vec2(limit_mps / speed_mps * desired_mps) : desired_mps;
}

bool IntermittentDiffusion::has_arrived(const ControlView& view) {
  find_in_range(view);
  return arrived_;
}

/// Begins a phase and draws the time at which it ends.
void IntermittentDiffusion::enter(Phase phase, const ControlView& view, Rng& rng) {
  phase_ = phase;
  begun_ = true;
  const double flow_s = to_seconds(options_->flow_time);
  // Random flow times keep the robots of a dense region from leaving it all at once. The time to a
  // target is twice that of a straight drive, plus one flow time to yield to others.
  until_ = view.now + from_seconds(phase == Phase::kShape
                                       ? uniform(rng, 0.2, 1.0) * flow_s
                                       : flow_s + 2.0 * target_.width_m / options_->cruise_mps);
}

/// Eq. 11: draws an intermediate target by a virtual diffusion, and heads for it by (14).
void IntermittentDiffusion::diffuse(const ControlView& view, Rng& rng) {
  const DiffusionPotential potential{shape_.get(), view.neighbours, options_->repulsion};
  const Vec2 end_m =
      virtual_diffusion(view.position_m, potential, view.world, true, options_->diffusion, rng);
  target_ = target_from(view.position_m, end_m, options_->radius_m);
  ++diffusions_;
  enter(Phase::kTarget, view, rng);
}

/// The phases of Alg. 1 and the changes between them, then one step of (10) or (14).
Vec2 IntermittentDiffusion::desired_velocity(const ControlView& view, bool, Rng& rng) {
  const NeighboursInRange& in_range = find_in_range(view);
  if (!begun_) enter(Phase::kShape, view, rng);

  const double to_target_m = (target_.end_m - view.position_m).norm();
  if (phase_ == Phase::kTarget &&
      (view.now >= until_ || to_target_m < kTargetReached * options_->radius_m ||
       energy_m2_ <= kRoom * options_->tolerance_m2)) {
    enter(Phase::kShape, view, rng);
  } else if (phase_ == Phase::kShape && view.now >= until_) {
    if (!arrived_ && options_->diffusion.time_s > 0.0) {
      diffuse(view, rng);
    } else {
      resting_ = options_->diffusion.time_s > 0.0;
      enter(Phase::kShape, view, rng);
    }
  }

  const bool to_target = phase_ == Phase::kTarget;
  Potential v = in_range.repulsion;
  v += to_target ? target_attraction(view.position_m, target_) : in_range.shape;
  remaining_m_ = to_target ? to_target_m : std::sqrt(in_range.shape.energy_m2);
  resting_ = resting_ && arrived_ && !to_target;
  return descend(v, in_range.reach_m) +
         obstacle_repulsion(view.position_m, view.world, options_->obstacles);
}

/// Only repulsion acts. The next phase begins anew.
Vec2 IntermittentDiffusion::hold(const ControlView& view) {
  begun_ = false;
  const NeighboursInRange& in_range = find_in_range(view);
  return descend(in_range.repulsion, in_range.reach_m) +
         obstacle_repulsion(view.position_m, view.world, options_->obstacles);
}

}  // namespace swarm::agent
