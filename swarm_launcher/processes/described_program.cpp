// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/described_program.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <string>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "swarmflow/core/time.hpp"

extern char** environ;

namespace swarm::launcher {
namespace {

constexpr std::size_t kMostBytes = 4U << 20U;

/// Reads until the other end closes; false if the time is over or the output is too long.
bool read_all(int pipe, SteadyTime deadline, std::string& text) {
  std::array<char, 4096> piece;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline - std::chrono::steady_clock::now());
    pollfd waiting{.fd = pipe, .events = POLLIN, .revents = 0};
    if (left.count() <= 0 || ::poll(&waiting, 1, static_cast<int>(left.count())) <= 0) return false;
    const ssize_t size = ::read(pipe, piece.data(), piece.size());
    if (size < 0 || text.size() > kMostBytes) return false;
    if (size == 0) return true;
    text.append(piece.data(), static_cast<std::size_t>(size));
  }
}

/// Waits until the process ends; false if the time is over. A program that closes its output need
/// not end.
bool wait_for(pid_t pid, SteadyTime deadline, int& status) {
  for (;;) {
    if (::waitpid(pid, &status, WNOHANG) != 0) return true;
    if (std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

/// Starts `program --describe` with its standard output in a pipe. Returns 0 or an errno.
int spawn(const std::filesystem::path& program, int out, pid_t& pid) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
  std::string path = program.string();
  std::string flag = "--describe";
  std::array<char*, 3> arguments{path.data(), flag.data(), nullptr};
  const int error = ::posix_spawn(&pid, path.c_str(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  return error;
}

}  // namespace

// The program may be anything that the user named: it is killed when it does not end in time.
Result<Catalogue> describe_program(const std::filesystem::path& program, Duration timeout) {
  const SteadyTime deadline = std::chrono::steady_clock::now() + timeout;
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    return fail(ErrorCode::kEnvironment, fmt::format("pipe: {}", std::strerror(errno)));
  }
  pid_t pid = 0;
  const int error = spawn(program, ends[1], pid);
  ::close(ends[1]);
  std::string text;
  bool ended = false;
  int status = 0;
  if (error == 0) {
    ended = read_all(ends[0], deadline, text) && wait_for(pid, deadline, status);
    if (!ended) {
      ::kill(pid, SIGKILL);
      ::waitpid(pid, &status, 0);
    }
  }
  ::close(ends[0]);
  if (error != 0) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: cannot be started: {}", program.string(), std::strerror(error)));
  }
  if (!ended || status != 0) {
    return fail(
        ErrorCode::kBadInput,
        fmt::format("{} --describe: {}; is it a program that calls run_robot() or "
                    "run_planner()?",
                    program.string(),
                    ended ? "ended with an error" : "did not end in time, or printed too much"));
  }
  return catalogue_from_json(text, program.string());
}

// Another program replaces the components of its kind: drivers and control methods belong to the
// agent, planning methods to the planner.
Result<Catalogue> catalogue_of(const std::filesystem::path& agent_program,
                               const std::filesystem::path& planner_program) {
  Catalogue catalogue = builtin_catalogue();
  if (!agent_program.empty()) {
    auto agent = describe_program(agent_program);
    if (!agent) return agent;
    catalogue.control_methods = std::move(agent->control_methods);
    catalogue.drivers = std::move(agent->drivers);
  }
  if (!planner_program.empty()) {
    auto planner = describe_program(planner_program);
    if (!planner) return planner;
    catalogue.planning_methods = std::move(planner->planning_methods);
  }
  return catalogue;
}

}  // namespace swarm::launcher
