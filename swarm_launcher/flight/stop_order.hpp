// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "swarm_link/channels/stop_channel.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// An emergency stop that a process sends to the robots on the stop channel, and the robots that
/// have confirmed it: only answers that name its id count. Single thread; the time is passed in.
class StopOrder {
 public:
  /// `robots`: number of robots of the run, if it is known.
  StopOrder(std::unique_ptr<link::StopSender> sender, std::optional<std::uint32_t> robots);

  /// Sends if a datagram is due: at every call in the first half second, then every 50 ms. Takes
  /// the confirmations. The UTC time of the first call is stamp and id of the stop.
  void step(SteadyTime now, UtcTime utc_now);

  /// Robots that confirmed in the last step, each once.
  const std::vector<RobotId>& newly_confirmed() const { return newly_; }
  /// Number of robots that have confirmed.
  std::uint32_t confirmed() const { return confirmed_; }
  /// Whether all robots have; false if their number is not known.
  bool is_complete() const { return robots_ && confirmed_ == *robots_; }
  /// Robots that have not confirmed; empty if their number is not known.
  std::vector<RobotId> unconfirmed() const;
  /// Since the first step.
  Duration elapsed(SteadyTime now) const { return begin_ ? now - *begin_ : Duration::zero(); }

 private:
  std::unique_ptr<link::StopSender> sender_;
  std::optional<std::uint32_t> robots_;
  std::optional<SteadyTime> begin_;
  SteadyTime next_;
  std::int64_t stamp_utc_ns_ = 0;
  std::vector<bool> has_confirmed_;  // by robot
  std::uint32_t confirmed_ = 0;
  std::vector<RobotId> newly_;
  std::vector<link::StopConfirmation> received_;
};

}  // namespace swarm::launcher
