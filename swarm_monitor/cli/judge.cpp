// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>

#include "swarm_monitor/cli/commands.hpp"
#include "swarm_monitor/report/report.hpp"

namespace swarm::monitor::cli {

/// The options live as long as the command, hence the shared pointer that its closure keeps.
Command add_audit(CLI::App& program) {
  struct Options {
    std::filesystem::path from;
    bool json = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* const audit = program.add_subcommand(
      "audit", "Recompute all results of a run from its logs; exit code 1 if it failed");
  audit->add_option("run", o->from, "Run directory, or a recording")
      ->required()
      ->check(CLI::ExistingPath)
      ->type_name("RUN_DIR|FILE");
  audit->add_flag("--json", o->json, "Print a JSON document");
  return {audit, [o]() -> Result<ExitCode> {
            const auto result = audit_run(o->from);
            if (!result) return tl::unexpected(result.error());
            std::fputs((o->json ? to_json(*result) : to_text(*result)).c_str(), stdout);
            // The exit code is the verdict, so that a script needs to parse nothing.
            return result->ok() ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
          }};
}

Command add_report(CLI::App& program) {
  const auto run_dir = std::make_shared<std::filesystem::path>();
  CLI::App* const report = program.add_subcommand(
      "report", "Write report.html, paths.svg and paths.png into the run directory");
  report->add_option("run_dir", *run_dir, "Run directory")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->type_name("RUN_DIR");
  return {report, [run_dir]() -> Result<ExitCode> {
            const auto result = write_report(*run_dir);
            if (!result) return tl::unexpected(result.error());
            for (const char* file : {"report.html", "paths.svg", "paths.png"}) {
              std::printf("%s\n", (*run_dir / file).c_str());
            }
            return ExitCode::kOk;
          }};
}

}  // namespace swarm::monitor::cli
