// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "robot_agent/methods/crops/fields/escape_walk.hpp"
#include "robot_agent/methods/crops/fields/give_way_field.hpp"
#include "robot_agent/methods/crops/fields/goal_field.hpp"
#include "robot_agent/methods/crops/fields/heading_field.hpp"
#include "robot_agent/methods/crops/fields/obstacle_field.hpp"
#include "robot_agent/methods/crops/fields/separation_field.hpp"
#include "robot_agent/route/goal_slot.hpp"
#include "robot_agent/route/guide_points.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarmflow/robot/control_method.hpp"

namespace swarm::agent {

/// The parameters of the motion and of its fields.
struct CropsOptions {
  double cruise_mps = 1.45;
  double approach_gain_hz = 0.8;  ///< speed per metre left, near the end of the path
  double full_strength = 0.3;     ///< strength of all fields together for cruise speed
  double stuck_wall_share = 0.1;  ///< share of the obstacles' field while stuck
  GuidePointsOptions guide{};
  GoalSlotOptions slot{};
  ObstacleFieldOptions obstacle{};
  SeparationFieldOptions separation{};
  GiveWayFieldOptions give_way{};
  GoalFieldOptions goal{};
  HeadingFieldOptions heading{};
  EscapeWalkOptions escape{};
};

/// Combined roadmaps and potentials, the motion of CRoPS: a robot goes from one intermediate goal
/// of the guide to the next (guide_points.hpp) in the direction of the superposition of its fields
/// (fields/), at cruise speed.
///
/// What differs from the paper, because bodies may not overlap here:
///   - the robot nearer to the goal goes first (fields/give_way_field.hpp);
///   - the path ends at the robot's own slot in the goal, and robots that have arrived make room
///     (goal_slot.hpp); there robots press instead of keeping apart;
///   - where the fields cancel, a robot stops instead of oscillating at full speed.
class Crops final : public ControlMethod {
 public:
  explicit Crops(Shared<CropsOptions> options)
      : options_(std::move(options)), escape_(options_->escape) {}

  void begin(const Route& route, const World& world) override;
  bool has_arrived(const ControlView& view) override;
  Vec2 desired_velocity(const ControlView& view, bool arrived, Rng& rng) override;
  Vec2 hold(const ControlView& view) override;
  std::uint32_t goal(const Vec2&) const override { return sink_; }
  double remaining_m() const override { return remaining_m_; }
  std::uint32_t escapes() const override { return escape_.escapes(); }

 private:
  Shared<CropsOptions> options_;
  GuidePoints guide_;
  GoalSlot slot_;
  EscapeWalk escape_;
  double remaining_m_ = 0.0;
  std::uint32_t sink_ = 0;
};

}  // namespace swarm::agent
