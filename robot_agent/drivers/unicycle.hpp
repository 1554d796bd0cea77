// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "robot_agent/drivers/motion_model.hpp"

namespace swarm::agent {

/// The limits of speed, acceleration and turning.
struct UnicycleLimits {
  double speed_max_mps = 1.5;
  double acceleration_max_mps2 = 3.0;
  double turn_rate_max_radps = 3.0;
};

/// A robot with two driven wheels; its position is the point between them:
///
///   ẋ = v (cos θ, sin θ),  θ̇ = ω,  0 ≤ v ≤ speed_max, |v̇| ≤ acceleration_max, |ω| ≤
///   turn_rate_max
///
/// It follows a velocity by follow_by_unicycle(). Integrated in steps of 5 ms at most.
class Unicycle final : public MotionModel {
 public:
  Unicycle(const Vec2& position_m, double heading_rad, const UnicycleLimits& limits)
      : limits_(limits), position_m_(position_m), heading_rad_(heading_rad) {}

  void advance(double time_s, const Vec2& wanted_mps) override;
  void displace(const Vec2& by_m) override { position_m_ += by_m; }
  Vec2 position_m() const override { return position_m_; }
  Vec2 velocity_mps() const override;
  bool has_lag() const override { return true; }

  double heading_rad() const { return heading_rad_; }  ///< θ, in [−π, π]
  double speed_mps() const { return speed_mps_; }      ///< v

 private:
  void step(double time_s, const Vec2& wanted_mps);

  UnicycleLimits limits_;
  Vec2 position_m_;
  double heading_rad_;
  double speed_mps_ = 0.0;
};

}  // namespace swarm::agent
