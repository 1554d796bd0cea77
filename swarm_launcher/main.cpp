// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/program.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_launcher/cli/commands.hpp"
#include "swarm_launcher/processes/builtin_catalogue.hpp"

int main(int argc, char** argv) {
  using namespace swarm;
  return shell::run_main("swarm_launcher", [&]() -> Result<ExitCode> {
    CLI::App app(
        "Runs a swarm: starts planner and robots, executes the mission script, supervises, "
        "reports.\n"
        "  swarm_launcher run deploy/missions/swarmprm_standin.yaml\n"
        "  swarm_launcher command RUN_DIR stop",
        "swarm_launcher");
    app.require_subcommand(1);
    shell::add_common_options(app);
    using namespace launcher::cli;
    // The order is the one of --help.
    const Command commands[] = {
        add_run(app),
        add_gateway(app),
        add_join(app),
        add_plan(app),
        add_keys(app),
        add_check_driver(app),
        add_command(app),
        add_sibling(app, "simulate",
                    "Simulate a mission in one process, as fast as the machine allows",
                    {"swarm_sim"}),
        add_sibling(app, "table",
                    "Simulate the experiments of a paper; prints the paper's numbers beside ours",
                    {"swarm_experiments", "table"}),
        add_sibling(app, "soak",
                    "Keep a swarm moving; measure latency, loss, memory and late ticks",
                    {"swarm_experiments", "soak"}),
        add_sibling(app, "chaos",
                    "Fly a mission again and again under random faults; audit each flight",
                    {"swarm_experiments", "chaos"})};
    // Parsing may already complete the program: --help, --version or an error.
    const auto done = shell::parse(app, argc, argv, builtin_catalogue());
    if (!done) return tl::unexpected(done.error());
    if (*done) return **done;
    shell::prepare_signals();
    for (const Command& command : commands) {
      if (command.app->parsed()) return command.act();
    }
    return ExitCode::kUsage;
  });
}
