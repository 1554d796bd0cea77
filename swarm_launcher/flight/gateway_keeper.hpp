// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// Keeps the gateway process of a flight running: whenever it ends, or cannot be started, it is
/// started again, ever more slowly while that happens in a row (see RestartPolicy). Without a
/// gateway the robots behind it and the others do not receive each other, so it is never given up.
/// Decides only; processes are started and ended by the functions it is given. Destruction ends the
/// process.
class GatewayKeeper {
 public:
  using Start = std::function<Result<pid_t>()>;
  using End = std::function<void(pid_t)>;

  GatewayKeeper(Start start, End end) : start_(std::move(start)), end_(std::move(end)) {}
  ~GatewayKeeper();
  GatewayKeeper(const GatewayKeeper&) = delete;
  GatewayKeeper& operator=(const GatewayKeeper&) = delete;

  /// The first start; a failure is the caller's.
  Result<void> start(SteadyTime now);
  /// An event if the child that ended was the gateway.
  std::optional<LogEvent> on_exit(pid_t pid, SteadyTime now);
  /// Starts the gateway again if that is due: an event of that, too.
  std::optional<LogEvent> step(SteadyTime now);

 private:
  LogEvent wait_for_restart(const std::string& reason, SteadyTime now);

  Start start_;
  End end_;
  RestartPolicy restarts_;
  pid_t pid_ = 0;  ///< 0: it does not run
  std::optional<SteadyTime> restart_at_;
};

}  // namespace swarm::launcher
