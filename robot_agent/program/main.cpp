// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <string>

#include <CLI/CLI.hpp>

#include "robot_agent/program/agent_process.hpp"
#include "swarm_core/shell/program.hpp"
#include "swarm_core/shell/stop_signal.hpp"

int main(int argc, char** argv) {
  using swarm::ExitCode;
  using swarm::Result;
  return swarm::shell::run_main("robot_agent", [&]() -> Result<ExitCode> {
    CLI::App app(
        "Moves one robot (or several) of a run, knowing only the plan, the map and the "
        "neighbours it hears.\nThe launcher starts it; to start one by hand: "
        "robot_agent --run RUN_DIR --ids 7",
        "robot_agent");
    swarm::agent::ProcessOptions options;
    std::uint32_t first = 0;
    std::string fault;
    const std::map<std::string, swarm::link::Vendor> vendors = {
        {"fastdds", swarm::link::Vendor::kFastDds},
        {"cyclonedds", swarm::link::Vendor::kCycloneDds}};
    app.add_option("--run", options.run_dir, "Run directory made by the launcher")->required();
    app.add_option("--ids", first, "First robot of this process")->required();
    app.add_option("--count", options.count, "Number of robots in this process");
    app.add_option("--number", options.number, "Of this agent process in the run, from 0");
    app.add_option("--parent", options.parent_pid, "End when this process is no longer our parent");
    app.add_option("--dds", options.vendor, "Whose DDS it speaks")
        ->transform(CLI::CheckedTransformer(vendors));
    app.add_flag("--by-gateway", options.by_gateway,
                 "Its states go by topics through the gateway, where the others' go by groups");
    app.add_option("--fault", fault, "A bad network for what this process receives");
    swarm::shell::add_common_options(app);
    const auto done = swarm::shell::parse(app, argc, argv);
    if (!done) return tl::unexpected(done.error());
    if (*done) return **done;
    const auto faults = swarm::parse_link_faults(fault);
    if (!faults) return tl::unexpected(faults.error());
    options.faults = *faults;
    options.first = swarm::RobotId(first);

    swarm::shell::catch_stop_signals();
    const auto process = swarm::agent::AgentProcess::make(options);
    if (!process) return tl::unexpected(process.error());
    if (const auto ran = (*process)->run(); !ran) return tl::unexpected(ran.error());
    return ExitCode::kOk;
  });
}
