// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <CLI/CLI.hpp>

#include "swarm_core/shell/program.hpp"
#include "swarm_monitor/report.hpp"

namespace {

using swarm::ExitCode;
using swarm::Result;

Result<ExitCode> audit(const std::filesystem::path& run_dir, bool json) {
  const auto result = swarm::monitor::audit_run(run_dir);
  if (!result) return tl::unexpected(result.error());
  std::fputs((json ? to_json(*result) : to_text(*result)).c_str(), stdout);
  return result->ok() ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
}

Result<ExitCode> report(const std::filesystem::path& run_dir) {
  const auto result = swarm::monitor::write_report(run_dir);
  if (!result) return tl::unexpected(result.error());
  std::printf("%s\n%s\n", (run_dir / "report.html").c_str(), (run_dir / "paths.svg").c_str());
  return ExitCode::kOk;
}

}  // namespace

int main(int argc, char** argv) {
  return swarm::shell::run_main("swarm_monitor", [&]() -> Result<ExitCode> {
    CLI::App app(
        "Judges a flown mission by the robots' black boxes.\n"
        "  swarm_monitor audit RUN_DIR    exits with 0 if the mission met its criteria, else 1\n"
        "  swarm_monitor report RUN_DIR   writes report.html and paths.svg into it",
        "swarm_monitor");
    app.require_subcommand(1);
    swarm::shell::add_common_options(app);
    std::filesystem::path run_dir;
    bool json = false;
    CLI::App* audit_command = app.add_subcommand("audit", "Recompute all results of a run");
    audit_command->add_option("run_dir", run_dir, "Directory of the run")->required();
    audit_command->add_flag("--json", json, "Print a JSON document");
    CLI::App* report_command = app.add_subcommand("report", "Write the run's report and map");
    report_command->add_option("run_dir", run_dir, "Directory of the run")->required();

    const auto done = swarm::shell::parse(app, argc, argv);
    if (!done) return tl::unexpected(done.error());
    if (*done) return **done;
    return report_command->parsed() ? report(run_dir) : audit(run_dir, json);
  });
}
