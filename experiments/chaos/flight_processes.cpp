// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/flight_processes.hpp"

#include <algorithm>
#include <csignal>
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

template <class IsWanted>
std::optional<pid_t> find_child(pid_t parent, const IsWanted& is_wanted) {
  for (const pid_t child : children_of(parent)) {
    if (is_wanted(command_line_of(child))) return child;
  }
  return std::nullopt;
}

}  // namespace

std::optional<pid_t> planner_of(const FlightParents& parents) {
  return find_child(parents.launcher, [](const std::vector<std::string>& line) {
    return is_program(line, "planner_service");
  });
}

std::optional<pid_t> gateway_of(const FlightParents& parents) {
  return find_child(parents.launcher, [](const std::vector<std::string>& line) {
    return is_program(line, "swarm_launcher") && line.size() > 1 && line[1] == "gateway";
  });
}

std::optional<pid_t> agent_of(const FlightParents& parents, std::uint32_t robot) {
  const auto flies_it = [id = fmt::format("{}", robot)](const std::vector<std::string>& line) {
    const auto ids = std::find(line.begin(), line.end(), "--ids");
    return is_program(line, "robot_agent") && line.end() - ids > 1 && *std::next(ids) == id;
  };
  const auto here = find_child(parents.launcher, flies_it);
  return here || parents.joined == 0 ? here : find_child(parents.joined, flies_it);
}

// The parents first: they would start their children again.
void kill_all(const FlightParents& parents) {
  std::vector<pid_t> all = {parents.launcher};
  if (parents.joined > 0) all.push_back(parents.joined);
  for (const pid_t parent : {parents.launcher, parents.joined}) {
    if (parent == 0) continue;
    const auto children = children_of(parent);
    all.insert(all.end(), children.begin(), children.end());
  }
  for (const pid_t pid : all) ::kill(pid, SIGKILL);
}

}  // namespace swarm::launcher
