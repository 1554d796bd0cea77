// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "planner_service/planner_process.hpp"
#include "swarm_core/shell/program.hpp"
#include "swarm_core/shell/stop_signal.hpp"

int main(int argc, char** argv) {
  using swarm::ExitCode;
  using swarm::Result;
  return swarm::shell::run_main("planner_service", [&]() -> Result<ExitCode> {
    CLI::App app(
        "Plans how the swarm flows and publishes the plan and the heartbeat of a run.\nThe "
        "launcher "
        "starts it; to start one by hand: planner_service --run RUN_DIR",
        "planner_service");
    swarm::planner::ProcessOptions options;
    std::string fault;
    app.add_option("--run", options.run_dir, "Run directory made by the launcher")->required();
    app.add_option("--parent", options.parent_pid, "End when this process is no longer our parent");
    app.add_option("--strength", options.ownership_strength,
                   "Ownership of the plan topic: agents follow the strongest living planner");
    app.add_option("--fault", fault, "A bad network for what this process receives");
    swarm::shell::add_common_options(app);
    const auto done = swarm::shell::parse(app, argc, argv);
    if (!done) return tl::unexpected(done.error());
    if (*done) return **done;
    const auto faults = swarm::parse_link_faults(fault);
    if (!faults) return tl::unexpected(faults.error());
    options.faults = *faults;

    swarm::shell::catch_stop_signals();
    const auto process = swarm::planner::PlannerProcess::make(options);
    if (!process) return tl::unexpected(process.error());
    if (const auto ran = (*process)->run(); !ran) return tl::unexpected(ran.error());
    return ExitCode::kOk;
  });
}
