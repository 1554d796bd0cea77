// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "swarm_link/gate/refusal.hpp"
#include "swarm_link/messages.hpp"

namespace swarm::link {

/// The newest plan of a planner that does not rule. The topic delivers it once, and its sender may
/// be about to take over: then the receiver passes it through its Gate again.
class WaitingPlan {
 public:
  /// Keeps a plan that the Gate has refused, if another planner than its own rules.
  void keep(PlanMessage&& refused, RefusalReason why, std::uint64_t ruling_epoch) {
    if (why == RefusalReason::kStale && refused.epoch != ruling_epoch) plan_ = std::move(refused);
  }
  /// The plan of the planner that rules now, once.
  std::optional<PlanMessage> take(std::uint64_t ruling_epoch) {
    if (!plan_ || plan_->epoch != ruling_epoch) return std::nullopt;
    return std::exchange(plan_, std::nullopt);
  }

 private:
  std::optional<PlanMessage> plan_{};
};

}  // namespace swarm::link
