// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/check_driver.hpp"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include "swarm_core/app/memory_file.hpp"
#include "swarm_launcher/processes/child_process.hpp"
#include "swarm_launcher/processes/described_program.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

/// Runs a program with our standard streams until it ends.
Result<ExitCode> run_program(std::vector<std::string> command_line) {
  std::vector<char*> arguments;
  for (std::string& argument : command_line) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  pid_t pid = 0;
  const int error = ::posix_spawn(&pid, command_line.front().c_str(), nullptr, nullptr,
                                  arguments.data(), environ);
  if (error != 0) {
    return fail(ErrorCode::kBadInput, fmt::format("{}: cannot be started: {}", command_line.front(),
                                                  std::strerror(error)));
  }
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status)) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("{}: ended by signal {}", command_line.front(), WTERMSIG(status)));
  }
  return static_cast<ExitCode>(WEXITSTATUS(status));
}

}  // namespace

Result<ExitCode> check_driver(const CheckDriverOptions& options) {
  const auto catalogue = catalogue_of(options.agent_program, {});
  if (!catalogue) return tl::unexpected(catalogue.error());
  const auto mission = load_mission(options.mission_file, *catalogue);
  if (!mission) return tl::unexpected(mission.error());
  const auto file = shell::MemoryFile::make("swarmflow-mission", to_yaml(*mission));
  if (!file) return tl::unexpected(file.error());
  std::vector<std::string> command_line = {
      program_or(options.agent_program, "robot_agent").string(), "--check-driver", file->path(),
      "--ids", std::to_string(options.robot)};
  command_line.insert(command_line.end(), options.more.begin(), options.more.end());
  return run_program(std::move(command_line));
}

}  // namespace swarm::launcher
