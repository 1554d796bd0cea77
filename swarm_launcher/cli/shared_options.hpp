// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "swarm_core/mission/channel.hpp"

/// Command line options common to the programs that fly a swarm: run and soak.
namespace swarm::launcher::cli {

/// Adds `--channel`. \pre `channel` outlives the program's options
void add_channel(CLI::App& command, std::optional<Channel>& channel);
/// Adds `--domain`. \pre `domain` outlives the program's options
void add_domain(CLI::App& command, int& domain);

/// Largest number of robots of a run; plans have no room for more.
inline constexpr int kMostRobots = 20'000;

/// Adds `--join-token`, also from the environment variable SWARMFLOW_JOIN_TOKEN, which other users
/// of the machine cannot read.
void add_join_token(CLI::App& command, std::string& token);

}  // namespace swarm::launcher::cli
