// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "robot_agent/drivers/motion_model.hpp"

namespace swarm::agent {

/// ẍ = a with ‖a‖ ≤ acceleration_max: changes its velocity v to the commanded one on a straight
/// line, as fast as it can.
///
///   a = a_max (u − v)/‖u − v‖ until v = u, then 0
///
/// Exact for any step.
class DoubleIntegrator final : public MotionModel {
 public:
  DoubleIntegrator(const Vec2& position_m, double speed_max_mps, double acceleration_max_mps2)
      : position_m_(position_m),
        speed_max_mps_(speed_max_mps),
        acceleration_max_mps2_(acceleration_max_mps2) {}

  void advance(double time_s, const Vec2& wanted_mps) override {
    const Vec2 target = limited(wanted_mps, speed_max_mps_);
    const Vec2 change = target - velocity_mps_;
    const double needed_s = change.norm() / acceleration_max_mps2_;
    const double changing_s = std::min(time_s, needed_s);
    if (changing_s > 0.0) {
      const Vec2 after = velocity_mps_ + change * (changing_s / needed_s);
      position_m_ += 0.5 * changing_s * (velocity_mps_ + after);
      velocity_mps_ = after;
    }
    if (time_s >= needed_s) {
      velocity_mps_ = target;
      position_m_ += (time_s - needed_s) * velocity_mps_;
    }
  }
  void displace(const Vec2& by_m) override { position_m_ += by_m; }
  Vec2 position_m() const override { return position_m_; }
  Vec2 velocity_mps() const override { return velocity_mps_; }
  bool has_lag() const override { return true; }

 private:
  Vec2 position_m_;
  Vec2 velocity_mps_ = Vec2::Zero();
  double speed_max_mps_;
  double acceleration_max_mps2_;
};

}  // namespace swarm::agent
