// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/gateway_keeper.hpp"

#include <utility>

#include <fmt/format.h>

namespace swarm::launcher {

// The child is reaped by the launcher's loop, or by init after it.
GatewayKeeper::~GatewayKeeper() {
  if (pid_ > 0) means_.end(pid_);
}

Result<void> GatewayKeeper::start(SteadyTime now) {
  const auto pid = means_.start();
  if (!pid) return tl::unexpected(pid.error());
  pid_ = *pid;
  is_killed_ = false;
  sign_of_life_ = now;
  restarts_.on_start(now);
  return {};
}

std::optional<LogEvent> GatewayKeeper::on_exit(pid_t pid, SteadyTime now) {
  if (pid_ == 0 || pid != pid_) return std::nullopt;
  pid_ = 0;
  is_up_ = false;
  robots_received_ = 0;
  return wait_for_restart("the gateway ended, see logs/gateway.log", now);
}

// A failed start counts as a process that ended at once.
std::optional<LogEvent> GatewayKeeper::step(SteadyTime now) {
  if (pid_ != 0) return watch(now);
  if (!restart_at_ || now < *restart_at_) return std::nullopt;
  restart_at_.reset();
  if (const auto started = start(now); !started) {
    restarts_.on_start(now);
    return wait_for_restart(started.error().message, now);
  }
  return LogEvent{.code = "gateway-restarted", .text = "the gateway runs again"};
}

// Its end is handled as any other. A launcher that was suspended finds the beats of that time.
std::optional<LogEvent> GatewayKeeper::watch(SteadyTime now) {
  if (const auto robots = means_.beat(pid_)) {
    is_up_ = true;
    robots_received_ = *robots;
    sign_of_life_ = now;
  }
  if (is_killed_ || now - sign_of_life_ <= (is_up_ ? kSilence : kFirstBeat)) return std::nullopt;
  is_up_ = false;
  robots_received_ = 0;
  is_killed_ = true;
  means_.kill(pid_);
  return LogEvent{.warning = true,
                  .code = "gateway-silent",
                  .text = fmt::format("the gateway has sent no beat for {:.0f} s: it is killed",
                                      to_seconds(now - sign_of_life_))};
}

LogEvent GatewayKeeper::wait_for_restart(const std::string& reason, SteadyTime now) {
  const Duration delay = restarts_.on_exit(now);
  restart_at_ = now + delay;
  return {.warning = true,
          .code = "gateway-exit",
          .text = fmt::format("{} (number {} in a row); it is started again in {:.1f} s", reason,
                              restarts_.deaths_in_a_row(), to_seconds(delay))};
}

}  // namespace swarm::launcher
