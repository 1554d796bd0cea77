// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include <sys/types.h>

#include "swarm_launcher/supervision/restart_policy.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Keeps the gateway process of a flight running: whenever it ends, hangs or cannot be started, it
/// is started again, ever more slowly while that happens in a row (see RestartPolicy). Without a
/// gateway the robots behind it and the others do not receive each other, so it is never given up.
/// Decides only; processes are started and ended by the functions it is given. Destruction ends the
/// process.
class GatewayKeeper {
 public:
  struct Means {
    std::function<Result<pid_t>()> start;
    std::function<void(pid_t)> end;
    std::function<void(pid_t)> kill;  ///< also one that hangs
    /// The newest beat since the last call: the number of robots that it receives by topics.
    std::function<std::optional<std::uint32_t>(pid_t)> beat;
  };
  /// Without a beat for longer, a gateway hangs: robots that do not receive each other meet soon.
  static constexpr Duration kSilence = std::chrono::seconds(2);
  /// It joins the bus before its first beat.
  static constexpr Duration kFirstBeat = std::chrono::seconds(30);

  explicit GatewayKeeper(Means means) : means_(std::move(means)) {}
  ~GatewayKeeper();
  GatewayKeeper(const GatewayKeeper&) = delete;
  GatewayKeeper& operator=(const GatewayKeeper&) = delete;

  /// The first start; a failure is the caller's.
  Result<void> start(SteadyTime now);
  /// An event if the child that ended was the gateway.
  std::optional<LogEvent> on_exit(pid_t pid, SteadyTime now);
  /// Starts the gateway again if that is due, and kills it if it hangs: an event of that, too.
  std::optional<LogEvent> step(SteadyTime now);
  /// The number of robots behind the gateway whose states it receives, as of the last step(); 0
  /// while it does not run. A gateway that was restarted is matched with them again one by one.
  std::uint32_t robots_received() const { return robots_received_; }

 private:
  LogEvent wait_for_restart(const std::string& reason, SteadyTime now);
  std::optional<LogEvent> watch(SteadyTime now);

  Means means_;
  RestartPolicy restarts_;
  pid_t pid_ = 0;       ///< 0: it does not run
  bool is_up_ = false;  ///< it has sent a beat since its start
  std::uint32_t robots_received_ = 0;
  bool is_killed_ = false;
  SteadyTime sign_of_life_{};  ///< its start, or its last beat
  std::optional<SteadyTime> restart_at_;
};

}  // namespace swarm::launcher
