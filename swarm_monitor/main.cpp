// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/program.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_monitor/cli/commands.hpp"

/// Each subcommand declares its options and a closure; the one that was given on the command line
/// is run.
int main(int argc, char** argv) {
  using namespace swarm;
  return shell::run_main("swarm_monitor", [&]() -> Result<ExitCode> {
    CLI::App app(
        "Shows a run in progress or afterwards, records it and audits it.\n"
        "  swarm_monitor audit RUN_DIR    exit code 0 if the mission met its criteria, else 1\n"
        "  swarm_monitor report RUN_DIR   writes report.html, paths.svg and paths.png into it\n"
        "  swarm_monitor view RUN_DIR     shows it in the browser, in progress or afterwards",
        "swarm_monitor");
    app.require_subcommand(1);
    shell::add_common_options(app);
    using namespace monitor::cli;
    const Command commands[] = {add_audit(app), add_report(app), add_record(app),
                                add_merge(app), add_replay(app), add_view(app),
                                add_top(app),   add_cat(app),    add_ros(app)};
    const auto done = shell::parse(app, argc, argv);
    if (!done) return tl::unexpected(done.error());
    if (*done) return **done;
    shell::prepare_signals();
    for (const Command& command : commands) {
      if (command.app->parsed()) return command.act();
    }
    return ExitCode::kUsage;
  });
}
