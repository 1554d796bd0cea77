// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/program/agent_process.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "robot_agent/loop/tick_phase.hpp"
#include "robot_agent/program/process_loop.hpp"
#include "swarm_core/app/file_thread.hpp"
#include "swarm_core/app/run_inputs.hpp"
#include "swarm_core/app/run_membership.hpp"
#include "swarm_core/app/shared_steps.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/base/clock.hpp"

namespace swarm::agent {
namespace {

/// Shorter ticks are not reported as overruns, however fast the control loop is.
constexpr Duration kLongTick = std::chrono::milliseconds(500);
/// Period of the look at how the files of the process can be written.
constexpr Duration kFilesEvery = std::chrono::seconds(1);
/// Until what a process sends last has been received; its writers end with it.
constexpr Duration kLinger = std::chrono::milliseconds(300);

/// Sleeps until `at`; false when a signal woke us early.
bool sleep_until(SteadyTime at) {
  const auto ns = at.time_since_epoch().count();
  const timespec when{.tv_sec = static_cast<time_t>(ns / 1'000'000'000),
                      .tv_nsec = static_cast<long>(ns % 1'000'000'000)};
  return ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr) != EINTR;
}

/// A process whose parent ended is adopted by another one: its parent's id changes.
bool parent_is_gone(std::uint32_t parent_pid) {
  return parent_pid != 0 && static_cast<std::uint32_t>(::getppid()) != parent_pid;
}

/// Robots fly without it, too: their last steps are in their logs then, if the disk takes them.
std::optional<shell::SharedSteps> open_steps(const ProcessOptions& options) {
  if (options.steps.empty()) return std::nullopt;
  auto steps = shell::SharedSteps::open(options.steps);
  const RobotId last(options.first.value() + options.count - 1);
  if (steps && steps->has(options.first) && steps->has(last)) return *std::move(steps);
  const std::string reason = steps ? "it has no place for these robots" : steps.error().message;
  std::fprintf(stderr, "--steps: %s; flying without\n", reason.c_str());
  return std::nullopt;
}

}  // namespace

/// Keeps the headers of mission and loop out of the public interface.
struct AgentProcess::Impl {
  ProcessOptions options;
  Mission mission;
  std::optional<shell::RobotLock> lock;
  shell::FileThread files;  // these two before the loop, whose robots write to them
  std::optional<shell::SharedSteps> steps;
  std::optional<ProcessLoop> loop;
};

AgentProcess::AgentProcess(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
AgentProcess::~AgentProcess() = default;

Catalogue catalogue_of(const RobotRegistry& registry) {
  return {.planning_methods = {},
          .control_methods = registry.control.specs(),
          .drivers = registry.drivers.specs(),
          .planning_is_open = true};
}

/// Joins the bus last: once others see the process, its robots are ready.
Result<std::unique_ptr<AgentProcess>> AgentProcess::make(const ProcessOptions& options,
                                                         const RobotRegistry& registry) {
  if (auto goes_on = shell::check_run_goes_on(options.run_dir); !goes_on) {
    return tl::unexpected(goes_on.error());
  }
  auto inputs = shell::read_run_inputs(options.run_dir, options.inputs, catalogue_of(registry));
  if (!inputs) return tl::unexpected(inputs.error());
  const shell::RunInfo& run = inputs->run;
  shell::follow(run.clock);
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  impl->mission = std::move(inputs->mission);
  const std::uint64_t end = std::uint64_t{options.first.value()} + options.count;
  if (end > impl->mission.robots.count || options.count == 0) {
    return fail(ErrorCode::kBadInput, fmt::format("--ids: the mission has robots 0 to {}",
                                                  impl->mission.robots.count - 1));
  }
  // Before the logs are opened: a second process must not write into them.
  auto lock = shell::RobotLock::take(options.run_dir, options.first, options.count);
  if (!lock) return tl::unexpected(lock.error());
  impl->lock.emplace(*std::move(lock));
  impl->steps = open_steps(options);
  auto world = std::make_unique<World>(impl->mission.world);
  auto robots = make_local_robots(impl->mission, *world, registry,
                                  {.files = impl->files,
                                   .steps = impl->steps ? &*impl->steps : nullptr,
                                   .run_dir = options.run_dir,
                                   .first = options.first,
                                   .count = options.count,
                                   .seed = run.seed,
                                   .now = std::chrono::steady_clock::now(),
                                   .utc_now = utc_now()});
  if (!robots) return tl::unexpected(robots.error());
  auto bus = join_bus(options, run, impl->mission);
  if (!bus) return tl::unexpected(bus.error());
  impl->loop.emplace(impl->mission, std::move(world), std::move(*robots), std::move(*bus));
  return std::unique_ptr<AgentProcess>(new AgentProcess(std::move(impl)));
}

/// Ticks at absolute times: multiples of the period on the steady clock, which all processes of a
/// host share, plus a phase that spreads processes over the period. A late tick does not shift the
/// next.
Result<void> AgentProcess::run() {
  Impl& p = *impl_;
  const Duration period = from_seconds(1.0 / p.mission.control.rate_hz);
  const Duration phase = from_seconds(to_seconds(period) * tick_phase(p.options.first.value()));
  const auto now = std::chrono::steady_clock::now();
  // Two periods after a command the body's watchdog has stopped it.
  const Duration overrun = std::max(2 * period, kLongTick);
  SteadyTime due = now - now.time_since_epoch() % period + period + phase;
  SteadyTime next = due;
  SteadyTime next_look = now;
  while (shell::stop_requests() == 0) {
    if (!sleep_until(next)) continue;
    const SteadyTime started = std::chrono::steady_clock::now();
    p.loop->tick({.now = started, .utc_now = utc_now(), .lateness = started - due});
    // After an overrun of whole periods the missed ticks are counted, by the lateness of the next
    // one, and not replayed in a burst.
    due += ((started - due) / period + 1) * period;
    const SteadyTime finished = std::chrono::steady_clock::now();
    if (finished - started > overrun) p.loop->on_overrun(utc_now(), finished - started);
    next = finished > due ? due + (finished - due) / period * period : due;
    if (finished >= next_look) {
      p.loop->on_files(utc_now(), p.files.health(finished));
      next_look = finished + kFilesEvery;
    }
    if (parent_is_gone(p.options.parent_pid)) break;
  }
  p.loop->end({.now = std::chrono::steady_clock::now(), .utc_now = utc_now()});
  const auto losses = p.files.finish();
  p.loop->on_losses(utc_now(), losses);
  if (!losses.empty()) std::this_thread::sleep_for(kLinger);
  return {};
}

}  // namespace swarm::agent
