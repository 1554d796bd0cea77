// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/simulation/simulate.hpp"

#include <memory>
#include <string>
#include <vector>

#include "swarm_launcher/cli/commands.hpp"
#include "swarm_launcher/table/table.hpp"

namespace swarm::launcher::cli {

Command add_simulate(CLI::App& program) {
  constexpr int kMostSimulated = 200'000;
  const auto o = std::make_shared<SimulateOptions>();
  const auto fault = std::make_shared<std::string>();
  const auto kills = std::make_shared<std::vector<std::string>>();
  CLI::App* const simulate = program.add_subcommand(
      "simulate", "Fly a mission in lock-step, in one process, as fast as it goes");
  simulate->add_option("mission", o->mission_file, "Mission file")
      ->required()
      ->type_name("MISSION.yaml");
  simulate->add_option("--robots", o->robots, "Number of robots, instead of the mission's")
      ->check(CLI::Range(1, kMostSimulated));
  simulate->add_option("--seed", o->seed, "Seed of placement, plan, robots, faults");
  simulate->add_option("--fault", *fault, "A bad network, as for run")->type_name("FAULT");
  simulate
      ->add_option("--kill", *kills,
                   "Robots die and their bodies stay: N@SECONDS drawn by the seed,\n"
                   "N@SECONDS,in=X0:Y0:X1:Y1 of those in a box, or ids:A,B@SECONDS; repeatable")
      ->allow_extra_args(false)
      ->type_name("KILL");
  simulate->add_flag_callback(
      "--clocks-apart", [o] { o->clocks_in_step = false; },
      "Robots tick at different moments of the control period");
  simulate->add_option("--threads", o->threads, "0: as many as make it faster")
      ->check(CLI::Range(0, 256));
  simulate->add_flag_callback(
      "--no-record", [o] { o->record = false; },
      "No robot logs, audit and report: arrivals and times alone");
  simulate->add_option("--out", o->out, "Run directory (default: runs/<mission>-<time>)");
  simulate->add_flag("--json", o->json, "Print the summary as JSON");
  return {simulate, [o, fault, kills]() -> Result<ExitCode> {
            const auto faults = parse_link_faults(*fault);
            if (!faults) return tl::unexpected(faults.error());
            o->faults = *faults;
            for (const std::string& text : *kills) {
              auto kill = parse_kill(text);
              if (!kill) return tl::unexpected(kill.error());
              o->kills.push_back(*std::move(kill));
            }
            return simulate_mission(*o);
          }};
}

Command add_table(CLI::App& program) {
  const auto o = std::make_shared<TableOptions>();
  CLI::App* const table = program.add_subcommand(
      "table", "Simulate a paper's experiment: its table, its peers and ours side by side");
  table->add_option("which", o->which, "The experiment")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>(kTables.begin(), kTables.end())));
  table->add_flag("--quick", o->quick, "Fewer robots and seeds");
  table->add_option("--missions", o->missions, "Where the mission files are");
  table->add_option("--out", o->out, "Directory for Markdown, JSON and pictures");
  return {table, [o] { return make_table(*o); }};
}

}  // namespace swarm::launcher::cli
