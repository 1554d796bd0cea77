// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "robot_agent/safety/safety_filter.hpp"
#include "robot_agent/neighbours/neighbour_table.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::agent {

struct SendOptions {
  double error_m = 0.05;    ///< speak when others' extrapolation of us is off by more
  Duration interval_max{};  ///< or when we have been silent this long
  double near_m = 1.0;      ///< on a degraded link: at every tick while a surface is nearer
  Duration period{};        ///< until it can speak again
};

/// What there is to say, and who listens.
struct SendInput {
  SteadyTime now;
  Vec2 position_m = Vec2::Zero();
  Vec2 velocity_mps = Vec2::Zero();
  Listeners listeners;
  LinkQuality link;
};

/// When a robot speaks (dead reckoning): others extrapolate its last state linearly, it does the
/// same and speaks before the difference matters, and before its silence does.
class SendPolicy {
 public:
  explicit SendPolicy(Shared<SendOptions> options) : options_(std::move(options)) {}

  bool must_send(const SendInput& input) const;

  void record_sent(const SendInput& input) { last_ = {input.now, input.position_m, input.velocity_mps}; }

 private:
  Shared<SendOptions> options_;
  struct SentState {
    SteadyTime now;
    Vec2 position_m = Vec2::Zero();
    Vec2 velocity_mps = Vec2::Zero();
  };
  std::optional<SentState> last_;
};

}  // namespace swarm::agent
