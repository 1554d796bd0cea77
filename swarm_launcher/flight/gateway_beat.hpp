// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include <sys/types.h>

#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// A gateway sends beats while it runs, as datagrams on a socket of the host that is named after
/// its launcher: it is no robot, and publishes nothing of its own on the bus.
constexpr Duration kGatewayBeatPeriod = std::chrono::milliseconds(200);

/// The launcher's end. Single thread; never blocks.
class GatewayBeatReceiver {
 public:
  /// \param launcher its process id. Without such sockets nothing is ever received.
  explicit GatewayBeatReceiver(pid_t launcher);
  ~GatewayBeatReceiver();
  GatewayBeatReceiver(const GatewayBeatReceiver&) = delete;
  GatewayBeatReceiver& operator=(const GatewayBeatReceiver&) = delete;

  /// The newest beat that the gateway with this process id has sent since the last call: the number
  /// of robots behind it whose states it receives. Empty if there is none.
  std::optional<std::uint32_t> take(pid_t gateway);

 private:
  int fd_;
};

/// The gateway's end. Single thread; never blocks; a launcher that does not read loses beats.
class GatewayBeatSender {
 public:
  explicit GatewayBeatSender(pid_t launcher);
  ~GatewayBeatSender();
  GatewayBeatSender(const GatewayBeatSender&) = delete;
  GatewayBeatSender& operator=(const GatewayBeatSender&) = delete;

  /// Whether the next beat is due.
  bool is_due(SteadyTime now) const { return now >= next_; }
  /// Sends a beat. `robots`: behind the gateway, whose states it receives.
  void send(std::uint32_t robots, SteadyTime now);

 private:
  pid_t launcher_;
  int fd_;
  SteadyTime next_{};
};

}  // namespace swarm::launcher
