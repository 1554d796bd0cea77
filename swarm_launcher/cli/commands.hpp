// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include <CLI/CLI.hpp>

#include "swarm_core/mission/channel.hpp"
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
Command add_simulate(CLI::App& program);
Command add_table(CLI::App& program);
Command add_soak(CLI::App& program);
Command add_keys(CLI::App& program);

/// The options that run and soak share. \pre what they fill outlives the program's options
void add_channel(CLI::App& command, std::optional<Channel>& channel);
void add_domain(CLI::App& command, int& domain);

inline constexpr int kMostRobots = 20'000;

}  // namespace swarm::launcher::cli
