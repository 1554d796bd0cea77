// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "robot_agent/drivers/motion_model.hpp"

namespace swarm::agent {

/// ẋ = u [SwarmPRM, eq. 15] with ‖u‖ ≤ speed_max: has a commanded velocity at once.
class SingleIntegrator final : public MotionModel {
 public:
  explicit SingleIntegrator(const Vec2& position_m,
                            double speed_max_mps = std::numeric_limits<double>::infinity())
      : position_m_(position_m), speed_max_mps_(speed_max_mps) {}

  void advance(double time_s, const Vec2& wanted_mps) override {
    velocity_mps_ = limited(wanted_mps, speed_max_mps_);
    position_m_ += time_s * velocity_mps_;
  }
  void displace(const Vec2& by_m) override { position_m_ += by_m; }
  Vec2 position_m() const override { return position_m_; }
  Vec2 velocity_mps() const override { return velocity_mps_; }
  bool has_lag() const override { return false; }

 private:
  Vec2 position_m_;
  Vec2 velocity_mps_ = Vec2::Zero();
  double speed_max_mps_;
};

}  // namespace swarm::agent
