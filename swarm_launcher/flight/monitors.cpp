// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/monitors.hpp"

#include <csignal>
#include <thread>

#include <fmt/format.h>
#include <sys/wait.h>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_launcher/processes/child_process.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kMonitorStep = std::chrono::milliseconds(20);
// The recorder needs this long at most to write what it has buffered.
constexpr Duration kMonitorTimeout = std::chrono::seconds(5);
constexpr std::size_t kMaxLogBytes = 1U << 20U;

}  // namespace

Monitors::~Monitors() {
  for (const auto& [pid, what] : running_) ::kill(pid, SIGTERM);
}

// Control through the view is off unless the user allowed it.
Result<void> Monitors::start() {
  const auto start_one = [this](const std::string& what, bool control) -> Result<void> {
    std::vector<std::string> line{sibling_program("swarm_monitor"), what, run_dir_.string()};
    if (control) line.emplace_back("--allow-control");
    const auto pid = start_process(line, run_dir_ / shell::kLogsFolder / (what + ".log"));
    if (!pid) return tl::unexpected(pid.error());
    running_[*pid] = what;
    return {};
  };
  if (options_.record) {
    if (auto started = start_one("record", false); !started) return started;
  }
  if (options_.view) return start_one("view", options_.allow_control);
  return {};
}

// The view prints its address as the first line of its log.
std::optional<std::string> Monitors::view_address() {
  if (!options_.view || reported_) return std::nullopt;
  const auto log = shell::read_file(run_dir_ / shell::kLogsFolder / "view.log", kMaxLogBytes);
  if (!log || !log->starts_with("http") || log->find('\n') == std::string::npos) {
    return std::nullopt;
  }
  reported_ = true;
  return log->substr(0, log->find('\n'));
}

std::optional<Monitors::Exit> Monitors::on_exit(pid_t pid) {
  const auto known = running_.find(pid);
  if (known == running_.end()) return std::nullopt;
  const std::string what = known->second;
  running_.erase(known);
  return Exit{.is_recorder = what == "record",
              .message = fmt::format("swarm_monitor {0} ended: see logs/{0}.log", what)};
}

// SIGINT makes the recorder finish its file. Waits for these children only; the launcher's loop has
// ended.
void Monitors::finish() {
  for (const auto& [pid, what] : running_) ::kill(pid, SIGINT);
  const auto until = std::chrono::steady_clock::now() + kMonitorTimeout;
  while (!running_.empty() && std::chrono::steady_clock::now() < until) {
    std::erase_if(running_, [](const auto& child) {
      int status = 0;
      return ::waitpid(child.first, &status, WNOHANG) != 0;
    });
    std::this_thread::sleep_for(kMonitorStep);
  }
}

}  // namespace swarm::launcher
