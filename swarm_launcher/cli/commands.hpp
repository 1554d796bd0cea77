// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "swarmflow/core/result.hpp"

/// The program's subcommands: one file each, or two that belong together.
namespace swarm::launcher::cli {

struct Command {
  CLI::App* app;                          ///< its options
  std::function<Result<ExitCode>()> act;  ///< what it does once they are read
};

Command add_run(CLI::App& program);
Command add_join(CLI::App& program);
Command add_gateway(CLI::App& program);
Command add_command(CLI::App& program);
Command add_plan(CLI::App& program);
/// `simulate`, `table` or `soak`: passes its arguments on to the program beside this one that has it.
Command add_sibling(CLI::App& program, const std::string& name, const std::string& description,
                    const std::vector<std::string>& command_line);
Command add_keys(CLI::App& program);

}  // namespace swarm::launcher::cli
