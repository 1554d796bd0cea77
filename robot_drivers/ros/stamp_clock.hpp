// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "swarm_ros/ros_time.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::drivers {

/// How old a stamped message is, by a clock that need not agree with ours: the least time from
/// stamp to reception so far counts as none. That least may grow by 100 ppm, as clocks drift.
/// A message with the stamp of the last one is the same again, and one with an earlier stamp is
/// late; neither counts. A clock that was set, back or by more than kLeap ahead, is a new one.
/// Pure.
class StampClock {
 public:
  static constexpr Duration kReset = std::chrono::seconds(1);
  static constexpr Duration kLeap = std::chrono::seconds(10);

  /// Age of a message received now; empty if it does not count. Of one without a stamp 0.
  std::optional<Duration> age_of(const ros::Time& stamp, SteadyTime now) {
    const Duration at = ros::duration_of(stamp);
    if (at == Duration::zero()) return Duration::zero();
    if (last_) {
      const Duration step = at - last_->stamp;
      const Duration passed = now - last_->received;
      if (step == Duration::zero()) return std::nullopt;
      if (step < Duration::zero() && passed < kReset) return std::nullopt;
      if (step < Duration::zero() || step > passed + kLeap) least_.reset();
    }
    const Duration offset = now.time_since_epoch() - at;
    if (least_) *least_ += (now - last_->received) / 10'000;
    least_ = least_ ? std::min(*least_, offset) : offset;
    last_ = {at, now};
    return offset - *least_;
  }

 private:
  struct Message {
    Duration stamp{};
    SteadyTime received{};
  };
  std::optional<Message> last_;
  std::optional<Duration> least_;
};

}  // namespace swarm::drivers
