// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "robot_agent/neighbours/neighbour_table.hpp"
#include "robot_agent/safety/safety_filter.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::agent {

/// When a state is published.
struct SendOptions {
  double error_m = 0.05;    ///< publish when others extrapolate this robot with a larger error
  Duration interval_max{};  ///< publish when the last published state is this old
  double near_m = 1.0;  ///< on a degraded link, publish at every tick with a neighbour this near
  Duration period{};    ///< of control: the time until the next chance to publish
  double scale = 1.0;   ///< of the constants of the policy (body_scale.hpp)
};

/// What the decision depends on: the own state, the neighbours that receive it and the link.
struct SendInput {
  SteadyTime now;
  Vec2 position_m = Vec2::Zero();
  Vec2 velocity_mps = Vec2::Zero();
  Listeners listeners;
  LinkQuality link;
};

/// Decides when a robot publishes its state (dead reckoning): others extrapolate its last state
/// linearly, it does the same, and publishes before the difference matters to them, and before its
/// silence makes a follower brake.
class SendPolicy {
 public:
  explicit SendPolicy(Shared<SendOptions> options) : options_(std::move(options)) {}

  bool must_send(const SendInput& input) const;

  void record_sent(const SendInput& input) {
    last_ = {input.now, input.position_m, input.velocity_mps};
  }

 private:
  Shared<SendOptions> options_;
  /// The state that others extrapolate.
  struct SentState {
    SteadyTime now;
    Vec2 position_m = Vec2::Zero();
    Vec2 velocity_mps = Vec2::Zero();
  };
  std::optional<SentState> last_;
};

}  // namespace swarm::agent
