// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>

#include <CLI/CLI.hpp>

#include "swarmflow/core/result.hpp"

/// A subcommand of the program.
namespace swarm::monitor::cli {

struct Command {
  CLI::App* app;                          ///< its options
  std::function<Result<ExitCode>()> act;  ///< what it does once they are read
};

/// Whether a run is in progress: its launcher runs, and has not written the summary with which it
/// ends.
bool is_in_progress(const std::filesystem::path& run_dir);
/// Fails (kEnvironment) with "this run is not in progress" after the end of a run.
Result<void> check_in_progress(const std::filesystem::path& run_dir);

/// Each declares its options at `program`; the returned action reads them after parsing.
Command add_audit(CLI::App& program);
Command add_report(CLI::App& program);
Command add_record(CLI::App& program);
Command add_merge(CLI::App& program);
Command add_cat(CLI::App& program);
Command add_replay(CLI::App& program);
Command add_view(CLI::App& program);
Command add_top(CLI::App& program);
Command add_ros(CLI::App& program);

}  // namespace swarm::monitor::cli
