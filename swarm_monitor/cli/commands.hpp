// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "swarmflow/core/result.hpp"

/// A subcommand of the program.
namespace swarm::monitor::cli {

struct Command {
  CLI::App* app;                          ///< its options
  std::function<Result<ExitCode>()> act;  ///< what it does once they are read
};

/// Each declares its options at `program`; the returned action reads them after parsing.
Command add_audit(CLI::App& program);
Command add_report(CLI::App& program);
Command add_record(CLI::App& program);
Command add_merge(CLI::App& program);
Command add_cat(CLI::App& program);
Command add_replay(CLI::App& program);
Command add_view(CLI::App& program);
Command add_top(CLI::App& program);

}  // namespace swarm::monitor::cli
