// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/shell/program.hpp"
#include "swarm_core/shell/stop_signal.hpp"
#include "swarm_launcher/builtin_catalogue.hpp"
#include "swarm_launcher/cli/commands.hpp"

int main(int argc, char** argv) {
  using namespace swarm;
  return shell::run_main("swarm_launcher", [&]() -> Result<ExitCode> {
    CLI::App app(
        "Flies a swarm: starts planner and robots, scripts the mission, supervises, reports.\n"
        "  swarm_launcher run deploy/missions/swarmprm_standin.yaml\n"
        "  swarm_launcher command RUN_DIR stop",
        "swarm_launcher");
    app.require_subcommand(1);
    shell::add_common_options(app);
    using namespace launcher::cli;
    const Command commands[] = {add_run(app),   add_gateway(app), add_join(app),
                                add_soak(app),  add_plan(app),    add_simulate(app),
                                add_table(app), add_command(app), add_keys(app)};
    const auto done = shell::parse(app, argc, argv, builtin_catalogue());
    if (!done) return tl::unexpected(done.error());
    if (*done) return **done;
    shell::catch_stop_signals();
    for (const Command& command : commands) {
      if (command.app->parsed()) return command.act();
    }
    return ExitCode::kUsage;
  });
}
