// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/flight_processes.hpp"

#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace swarm::launcher {
namespace {

std::vector<pid_t> children_of(pid_t parent) {
  std::ifstream file(fmt::format("/proc/{}/task/{}/children", parent, parent));
  return {std::istream_iterator<pid_t>(file), {}};
}

/// The arguments of a process; the first is its program.
std::vector<std::string> command_line_of(pid_t pid) {
  std::ifstream file(fmt::format("/proc/{}/cmdline", pid));
  std::vector<std::string> arguments;
  for (std::string argument; std::getline(file, argument, '\0');) arguments.push_back(argument);
  return arguments;
}

bool is_program(const std::vector<std::string>& command_line, std::string_view name) {
  return !command_line.empty() && command_line.front().ends_with(name);
}

}  // namespace

std::optional<pid_t> planner_of(pid_t launcher) {
  for (const pid_t child : children_of(launcher)) {
    if (is_program(command_line_of(child), "planner_service")) return child;
  }
  return std::nullopt;
}

std::optional<pid_t> agent_of(pid_t launcher, std::uint32_t robot) {
  const std::string id = fmt::format("{}", robot);
  for (const pid_t child : children_of(launcher)) {
    const auto arguments = command_line_of(child);
    if (!is_program(arguments, "robot_agent")) continue;
    for (std::size_t i = 0; i + 1 < arguments.size(); ++i) {
      if (arguments[i] == "--ids" && arguments[i + 1] == id) return child;
    }
  }
  return std::nullopt;
}

}  // namespace swarm::launcher
