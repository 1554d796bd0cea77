// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "robot_agent/drivers/driver.hpp"

namespace swarm::agent {

/// A single integrator ẋ = u [SwarmPRM, eq. 15] with perfect position sensing, moved by the clock
/// it is shown; stops when its command runs out.
class SimulatedRobot final : public Driver {
 public:
  SimulatedRobot(SteadyTime now, const Vec2& position_m) : position_m_(position_m), at_(now) {}

  Measurement measure(SteadyTime now) override {
    Measurement m;
    const SteadyTime until = std::min(now, valid_until_);
    if (until > at_) position_m_ += to_seconds(until - at_) * velocity_mps_;
    if (now > valid_until_ && velocity_mps_ != Vec2::Zero()) {
      m.command_expired = true;
      m.expired_at = valid_until_;
      velocity_mps_ = Vec2::Zero();
    }
    at_ = std::max(at_, now);
    m.position_m = position_m_;
    return m;
  }

  void command(SteadyTime now, const Vec2& velocity_mps, Duration valid_for) override {
    velocity_mps_ = velocity_mps;
    valid_until_ = now + valid_for;
  }

 private:
  Vec2 position_m_;
  Vec2 velocity_mps_ = Vec2::Zero();
  SteadyTime at_;
  SteadyTime valid_until_;
};

}  // namespace swarm::agent
