// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/catalogue.hpp"

namespace CLI {
class App;
}

/// What the main() functions of all programs share. Domain code never includes this.
namespace swarm::shell {

/// Runs a program's body: prints an error to stderr as `name: message` (every line) and turns it
/// into the exit code. Fails too if what the body printed could not be written (output.hpp). The
/// only catch-all of a program.
int run_main(const std::string& name, const std::function<Result<ExitCode>()>& body);

/// The name for messages and help: `own`, or argv[0] if swarm_launcher started this program as one
/// of its subcommands, as in `swarm_launcher simulate`.
std::string program_name(const char* argv0, const std::string& own);

/// Adds `--version` and `--check MISSION.yaml` (validate and exit), which every program has.
void add_common_options(CLI::App& app);

/// Why a text is no whole decimal number, which has no leading zero and, unless it `has_sign`, no
/// minus; empty if it is one. As validators of options have it.
std::string objection_to_whole(const std::string& text, bool has_sign = false);

/// Parses the command line; options of type INT, UINT and FLOAT take decimal numbers only. Holds an
/// exit code when there is nothing left to do (help, version, check); kBadInput on wrong usage.
/// `--check` checks the components of `catalogue`; a program that has only some of them leaves the
/// sections of the others open.
Result<std::optional<ExitCode>> parse(CLI::App& app, int argc, char** argv,
                                      const Catalogue& catalogue = open_catalogue());

}  // namespace swarm::shell
