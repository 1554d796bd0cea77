// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/planning/run_planner.hpp"

#include <cstdio>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "planner_service/program/planner_process.hpp"
#include "swarm_core/app/program.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/mission/link_faults.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::planner {
namespace {

/// The options of the command line, or the exit code where the program ends there (--help).
Result<std::optional<ExitCode>> read_options(int argc, char** argv,
                                             const PlanningRegistry& registry,
                                             ProcessOptions& options) {
  CLI::App app(
      "Computes the plan of a run; publishes it, and the heartbeat with the plan's clock.\nThe "
      "launcher "
      "starts it; to start one by hand: planner_service --run RUN_DIR",
      "planner_service");
  std::string fault;
  app.add_option("--run", options.run_dir, "Run directory made by the launcher");
  app.add_option("--inputs", options.inputs,
                 "Run and mission in one file; without it those of the run directory");
  app.add_option("--parent", options.parent_pid, "End when this process is no longer the parent");
  std::uint32_t strength = 0;
  app.add_option("--strength", strength,
                 "Without effect; of two planners the one that started first leads");
  app.add_option(
      "--fault", fault,
      "Degrades what this process receives:\n"
      "loss=0.2,delay-ms=150,jitter-ms=50,duplicate=0.1,from=10,to=60,robots=3-5,launcher=1");
  bool describe = false;
  app.add_flag("--describe", describe,
               "Print its planning methods with their options as JSON, and exit");
  shell::add_common_options(app);
  auto done = shell::parse(app, argc, argv, registry.catalogue());
  if (!done || *done) return done;
  if (describe) {
    std::puts(to_json(registry.catalogue()).c_str());
    return ExitCode::kOk;
  }
  if (options.run_dir.empty()) {
    return fail(ErrorCode::kBadInput, "--run is required; the launcher gives it");
  }
  const auto faults = parse_link_faults(fault);
  if (!faults) return tl::unexpected(faults.error());
  if (faults->at_planner()) options.faults = *faults;
  return done;
}

}  // namespace

// Signals are caught before the process is made, so that a stop during the first plan is not lost.
int run_planner(int argc, char** argv, const PlanningRegistry& registry) {
  return shell::run_main("planner_service", [&]() -> Result<ExitCode> {
    ProcessOptions options;
    const auto done = read_options(argc, argv, registry, options);
    if (!done) return tl::unexpected(done.error());
    if (*done) return **done;
    shell::catch_stop_signals();
    const auto process = PlannerProcess::make(options, registry);
    if (!process) return tl::unexpected(process.error());
    if (const auto ran = (*process)->run(); !ran) return tl::unexpected(ran.error());
    return ExitCode::kOk;
  });
}

}  // namespace swarm::planner
