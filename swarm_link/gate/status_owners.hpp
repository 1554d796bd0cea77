// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "swarm_link/gate/refusal.hpp"
#include "swarm_link/messages.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::link {

/// Whose message was received, and when.
struct Sent {
  std::uint64_t sender = 0;  ///< RawSample::sender; 0: unknown, which is not checked
  UtcTime received{};
};

/// Which sender's statuses count for each robot: the first one that is received after the start of
/// the robot's process. Another one is followed only once the process has ended, or when the owner
/// has been silent for the takeover time. So no other process confirms commands in a robot's name.
/// A sender that is received before the robot owns its statuses until it is silent. Pure; times are
/// of the receiver's clock.
class StatusOwners {
 public:
  explicit StatusOwners(Duration takeover) : takeover_(takeover) {}

  /// Accepts a status if all of its robots are the sender's, and makes it their owner. Sender 0 is
  /// unknown: its statuses pass and own nothing. Refuses as forged what another one owns, and as
  /// stale what a process sent before its end. \pre the status has passed check_status()
  Checked<void> accept(const StatusMessage& message, const Sent& sent) {
    const auto [sender, now] = sent;
    for (const RobotStatusMessage& robot : message.robots) {
      const Owner& owner = owner_of(robot.robot_id);
      if (owner.ended_at && UtcTime(Duration(message.stamp_utc_ns)) <= *owner.ended_at) {
        return refuse(RefusalReason::kStale);
      }
      if (sender != 0 && owner.sender != sender && is_owned(owner, now)) {
        return refuse(RefusalReason::kForged);
      }
    }
    if (sender == 0) return {};
    for (const RobotStatusMessage& robot : message.robots) {
      owner_of(robot.robot_id) = {.sender = sender, .received_at = now};
    }
    return {};
  }

  /// The process of a robot has ended: its statuses no longer count, those of the next one do.
  void release(RobotId robot, UtcTime now) { owner_of(robot.value()).ended_at = now; }

  /// Whether the sender owns the robot's statuses, or was the last one to do so.
  bool is_of(RobotId robot, std::uint64_t sender) const {
    return robot.value() < owners_.size() && owners_[robot.value()].sender == sender;
  }
  /// Whether no other sender owns the robot's statuses.
  bool may_be_of(RobotId robot, std::uint64_t sender, UtcTime now) const {
    return robot.value() >= owners_.size() || is_of(robot, sender) ||
           !is_owned(owners_[robot.value()], now);
  }

 private:
  struct Owner {
    std::uint64_t sender = 0;           ///< the last one; 0: none
    UtcTime received_at{};              ///< its last status
    std::optional<UtcTime> ended_at{};  ///< of the process before, until the next one reports
  };

  bool is_owned(const Owner& owner, UtcTime now) const {
    return owner.sender != 0 && !owner.ended_at && now - owner.received_at <= takeover_;
  }
  Owner& owner_of(std::uint32_t robot) {
    if (robot >= owners_.size()) owners_.resize(std::size_t{robot} + 1);
    return owners_[robot];
  }

  Duration takeover_;
  std::vector<Owner> owners_;  ///< by robot
};

}  // namespace swarm::link
