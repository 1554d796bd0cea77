// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "swarmflow/core/result.hpp"

/// The program's subcommands: one source file each, or one for two related ones.
namespace swarm::launcher::cli {

/// A subcommand as CLI11 has it, and the function that executes it.
struct Command {
  CLI::App* app;                          ///< owned by the program
  std::function<Result<ExitCode>()> act;  ///< called once the options are parsed
};

/// Each function adds a subcommand with its options; see swarm_launcher/commands for what they do.
Command add_run(CLI::App& program);
Command add_join(CLI::App& program);
Command add_gateway(CLI::App& program);
Command add_command(CLI::App& program);
Command add_plan(CLI::App& program);
Command add_check_driver(CLI::App& program);
/// `simulate`, `table`, `soak` or `chaos`: replaces this process by the program beside it that
/// implements the subcommand, with all its arguments.
Command add_sibling(CLI::App& program, const std::string& name, const std::string& description,
                    const std::vector<std::string>& command_line);
Command add_keys(CLI::App& program);

}  // namespace swarm::launcher::cli
