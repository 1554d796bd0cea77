// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/stop_robots.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "swarm_core/app/control_socket.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_launcher/flight/stop_order.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(20);
constexpr Duration kTimeout = std::chrono::seconds(5);
constexpr Duration kQuiet = std::chrono::seconds(1);  // no further confirmation: that was all

SteadyTime steady_now() { return std::chrono::steady_clock::now(); }

std::string list_of(const std::vector<RobotId>& robots) {
  constexpr std::size_t kMost = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(robots.size(), kMost); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ", ", robots[i].value());
  }
  if (robots.size() > kMost) text += fmt::format(" and {} more", robots.size() - kMost);
  return text;
}

/// The result by the robots' own confirmations, for want of an answer of the launcher.
ExitCode report(const StopOrder& order) {
  if (order.is_complete()) {
    std::printf("done: all %u robots confirmed that they stopped; the launcher did not answer\n",
                order.confirmed());
    return ExitCode::kOk;
  }
  std::printf(
      "failed: %u robots confirmed that they stopped, not: %s; the launcher did not answer\n",
      order.confirmed(), list_of(order.unconfirmed()).c_str());
  return ExitCode::kCriteriaNotMet;
}

}  // namespace

Result<ExitCode> stop_run(const std::filesystem::path& run_dir) {
  const auto run = shell::read_run_info(run_dir);
  if (!run) {
    return fail(run.error().code, run.error().message +
                                      "\nwithout the run directory: swarm_launcher command "
                                      "--domain N stop; the launcher printed the domain");
  }
  std::optional<std::uint32_t> robots;
  if (const auto mission = load_mission(run_dir / shell::kMissionFile)) {
    robots = mission->robots.count;
  }
  auto sender = link::StopSender::open({.domain = run->domain, .interface = run->interface});
  std::optional<StopOrder> order;
  if (sender) order.emplace(std::move(*sender), robots);
  const auto on_wait = [&] {
    if (!order) return true;
    const SteadyTime now = steady_now();
    order->step(now, utc_now());
    // The launcher names the robots that it misses after 5 s; one that hangs is not waited for.
    const bool may_answer = order->elapsed(now) < kTimeout + kQuiet;
    return may_answer && !(order->is_complete() && order->elapsed(now) > 2 * kQuiet);
  };
  const auto print = [](const std::string& answer) { std::printf("%s\n", answer.c_str()); };
  const auto done = shell::send_command(run_dir, "stop", print, on_wait);
  if (done) return *done ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
  if (!order) return tl::unexpected(done.error());
  while (on_wait()) std::this_thread::sleep_for(kStep);
  return report(*order);
}

Result<ExitCode> stop_domain(std::uint32_t domain, const std::string& interface) {
  auto sender = link::StopSender::open({.domain = domain, .interface = interface});
  if (!sender) return tl::unexpected(sender.error());
  StopOrder order(std::move(*sender), std::nullopt);
  SteadyTime changed = steady_now();
  for (std::uint32_t before = 0; order.elapsed(steady_now()) < kTimeout;) {
    order.step(steady_now(), utc_now());
    if (order.confirmed() != before) changed = steady_now();
    before = order.confirmed();
    if (before > 0 && steady_now() - changed > kQuiet) break;
    std::this_thread::sleep_for(kStep);
  }
  std::printf("%s: %u robots of domain %u confirmed that they stopped\n",
              order.confirmed() > 0 ? "done" : "failed", order.confirmed(), domain);
  return order.confirmed() > 0 ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
}

}  // namespace swarm::launcher
