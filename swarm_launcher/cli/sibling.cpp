// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <unistd.h>

#include "swarm_launcher/cli/commands.hpp"
#include "swarm_launcher/processes/child_process.hpp"

namespace swarm::launcher::cli {
namespace {

/// Replaces this process; returns only if that fails. `name` becomes argv[0], by which the other
/// program's --help shows the command as the user typed it.
Error become(const std::string& name, std::vector<std::string> command_line) {
  const std::string program = sibling_program(command_line.front()).string();
  command_line.front() = name;
  std::vector<char*> arguments;
  for (std::string& argument : command_line) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  ::execv(program.c_str(), arguments.data());
  return {.code = ErrorCode::kEnvironment,
          .message = fmt::format("{}: {}", program, std::strerror(errno))};
}

}  // namespace

Command add_sibling(CLI::App& program, const std::string& name, const std::string& description,
                    const std::vector<std::string>& command_line) {
  CLI::App* const sibling = program.add_subcommand(name, description);
  sibling->prefix_command();   // its arguments are the other program's
  sibling->set_help_flag("");  // and so is --help
  // A subcommand of the other program is in its command line; a whole program is one here.
  const std::string shown = command_line.size() > 1 ? "swarm_launcher" : "swarm_launcher " + name;
  return {sibling, [sibling, shown, command_line]() -> Result<ExitCode> {
            std::vector<std::string> all = command_line;
            const std::vector<std::string> arguments = sibling->remaining();
            all.insert(all.end(), arguments.begin(), arguments.end());
            return tl::unexpected(become(shown, std::move(all)));
          }};
}

}  // namespace swarm::launcher::cli
