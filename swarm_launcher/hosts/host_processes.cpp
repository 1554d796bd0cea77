// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/host_processes.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "swarm_core/app/run_dir.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kStart = std::chrono::seconds(30);
constexpr int kNotStarted = 127;  // as a shell has it

}  // namespace

HostProcesses::HostProcesses(const HostOffer& offer, HostProcessesOptions options)
    : offer_(offer), options_(std::move(options)), queue_(options_.respawns) {
  for (std::uint32_t robot = 0; robot < offer.robots; robot += offer.per_process) queue_.add(robot);
}

void HostProcesses::step() {
  const SteadyTime now = std::chrono::steady_clock::now();
  while (const auto child = reap_child()) {
    const auto known = children_.find(child->pid);
    if (known == children_.end()) continue;
    const std::uint32_t robot = known->second.robot;
    children_.erase(known);
    if (ending_) continue;
    ProcessExit exit = child->exit;
    exit.is_restarted = queue_.on_exit(robot, now);
    exits_.emplace_back(robot / offer_.per_process, exit);
  }
  if (ending_) return;
  const auto next = queue_.next(now);
  if (!next) return;
  if (const auto started = start(*next); !started) {
    std::fprintf(stderr, "%s\n", started.error().message.c_str());
    exits_.emplace_back(
        *next / offer_.per_process,
        ProcessExit{.code = kNotStarted, .is_restarted = queue_.on_exit(*next, now)});
  }
}

void HostProcesses::signal(int number) {
  ending_ = true;
  for (const auto& [pid, child] : children_) ::kill(pid, number);
}

void HostProcesses::kill_hung(const std::set<std::uint32_t>& processes) {
  const SteadyTime now = std::chrono::steady_clock::now();
  std::vector<pid_t> hung;
  for (const auto& [pid, child] : children_) {
    const bool is_meant = processes.contains(child.robot / offer_.per_process);
    if (is_meant && now - child.started_at > kStart) hung.push_back(pid);
  }
  // Of several most at once: the machine is overloaded.
  if (children_.size() > 1 && 2 * hung.size() > children_.size()) return;
  for (const pid_t pid : hung) ::kill(pid, SIGKILL);
}

Result<void> HostProcesses::start(std::uint32_t robot) {
  const std::uint32_t id = offer_.first_robot + robot;
  std::vector<std::string> command_line = {
      sibling_program("robot_agent"),
      "--run",
      options_.dir.string(),
      "--steps",
      options_.steps,
      "--inputs",
      options_.inputs,
      "--ids",
      fmt::format("{}", id),
      "--count",
      fmt::format("{}", std::min(offer_.per_process, offer_.robots - robot)),
      "--number",
      fmt::format("{}", offer_.first_process + robot / offer_.per_process),
      "--parent",
      fmt::format("{}", ::getpid())};
  if (!offer_.fault.empty()) command_line.insert(command_line.end(), {"--fault", offer_.fault});
  if (options_.dds != link::Vendor::kFastDds) {
    command_line.insert(command_line.end(), {"--dds", std::string(to_string(options_.dds))});
  }
  const auto log = options_.dir / shell::kLogsFolder / fmt::format("agent-{:05}.log", id);
  const auto pid = start_process(command_line, log);
  if (!pid) return tl::unexpected(pid.error());
  children_.emplace(*pid, Child{.robot = robot, .started_at = std::chrono::steady_clock::now()});
  return {};
}

}  // namespace swarm::launcher
