// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/ros/stop_command.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace swarm::monitor {
namespace {

constexpr Duration kAgain = std::chrono::milliseconds(500);

/// The launcher beside this program.
std::string launcher() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (self.parent_path() / "swarm_launcher").string();
}

std::optional<pid_t> spawn_stop(const std::filesystem::path& run_dir) {
  std::string program = launcher(), command = "command", dir = run_dir.string(), stop = "stop";
  std::array<char*, 5> arguments{program.data(), command.data(), dir.data(), stop.data(), nullptr};
  pid_t pid = 0;
  const int error =
      ::posix_spawn(&pid, program.c_str(), nullptr, nullptr, arguments.data(), environ);
  if (error == 0) return pid;
  std::fprintf(stderr, "%s: %s\n", program.c_str(), std::strerror(error));
  return std::nullopt;
}

}  // namespace

// It ends by itself.
StopCommand::~StopCommand() {
  if (child_) ::waitpid(*child_, nullptr, 0);
}

void StopCommand::step(SteadyTime now) {
  if (child_) {
    int status = 0;
    const pid_t ended = ::waitpid(*child_, &status, WNOHANG);
    if (ended == 0 || (ended < 0 && errno == EINTR)) return;
    child_.reset();
    is_done_ = ended > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (!is_done_) failed_at_ = now;
  }
  if (!is_pending(now) || (failed_at_ && now - *failed_at_ < kAgain)) return;
  child_ = spawn_stop(run_dir_);
  if (!child_) failed_at_ = now;
}

}  // namespace swarm::monitor
