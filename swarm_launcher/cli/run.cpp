// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/run.hpp"

#include <memory>
#include <string>
#include <vector>

#include "swarm_core/app/program.hpp"
#include "swarm_launcher/cli/commands.hpp"
#include "swarm_launcher/cli/shared_options.hpp"
#include "swarm_launcher/processes/run_vendors.hpp"

namespace swarm::launcher::cli {

namespace {

/// Options that choose the DDS of each program. A refused value is reported with the option's name.
void add_dds(CLI::App& run, const std::shared_ptr<RunOptions>& o) {
  run.add_option_function<std::vector<std::string>>(
         "--dds",
         [o](const std::vector<std::string>& choices) {
           for (const std::string& choice : choices) {
             if (const auto applied = apply_vendor(choice, o->how.dds); !applied) {
               throw CLI::ValidationError("--dds", applied.error().message);
             }
           }
         },
         "DDS vendor, fastdds or cyclonedds (groups channel), of the launcher, planner or agents;\n"
         "without ROLE of all three; repeat it for several roles, the last one counts")
      ->allow_extra_args(false)
      ->type_name("[ROLE=]VENDOR");
  run.add_option("--by-gateway", o->how.by_gateway,
                 "The first N agent processes use Cyclone DDS and publish their states on\n"
                 "topics; a gateway connects them with the groups of the others");
}

}  // namespace

// The options are shared with the callback, which runs after parsing.
Command add_run(CLI::App& program) {
  const auto o = std::make_shared<RunOptions>();
  CLI::App* const run = program.add_subcommand("run", "Fly a mission with one process per robot");
  run->add_option("mission", o->mission_file, "Mission file")
      ->required()
      ->type_name("MISSION.yaml");
  run->add_option("--robots", o->robots, "Number of robots, instead of the mission's")
      ->check(CLI::Range(1, kMostRobots));
  auto* const per_process =
      run->add_option("--per-process", o->per_process, "Robots hosted by one agent process")
          ->check(CLI::Range(1, kMostRobots));
  run->add_option_function<std::string>(
         "--processes",
         [o](const std::string& n) {
           o->processes = n == "auto" ? 0U : static_cast<std::uint32_t>(std::stoul(n));
         },
         "Agent processes, or auto: one per robot if the machine can run them, else few")
      ->check(CLI::IsMember({"auto"}) | CLI::Range(1, kMostRobots))
      ->check([](const std::string& n) {
        return n == "auto" ? std::string() : shell::objection_to_whole(n);
      })
      ->type_name("N|auto")
      ->excludes(per_process);
  run->add_option("--seed", o->how.seed, "Seed of placement, plan and robots");
  run->add_option("--out", o->how.out, "Run directory (default: runs/<mission>-<time>)");
  run->add_option("--agent-program", o->how.agent_program,
                  "Robot program with drivers or control methods of your own (run_robot)")
      ->check(CLI::ExistingFile);
  run->add_option("--planner-program", o->how.planner_program,
                  "Planner program with planning methods of your own (run_planner)")
      ->check(CLI::ExistingFile);
  add_domain(*run, o->how.domain);
  add_channel(*run, o->how.channel);
  add_dds(*run, o);
  run->add_option(
         "--fault", o->how.fault,
         "Simulate a degraded network for what planner and robots receive, such as\n"
         "loss=0.2,delay-ms=150,jitter-ms=50,duplicate=0.1,from=10,to=60,robots=3-5,launcher=1")
      ->type_name("FAULT");
  run->add_option("--interface", o->how.interface, "IPv4 address of the interface to other hosts")
      ->check(CLI::ValidIPV4);
  run->add_option("--remote", o->how.remote,
                  "Number of robots that other hosts start (the last ones): see join");
  run->add_option("--join-port", o->how.join_port,
                  "TCP port at which those hosts connect (default: a free one)");
  add_join_token(*run, o->how.join_token);
  run->add_flag("--record", o->how.monitors.record,
                "Record the bus: bus.mcap in the run directory");
  auto* const view = run->add_flag("--view", o->how.monitors.view, "Show the run in the browser");
  run->add_flag("--allow-control", o->how.monitors.allow_control,
                "Let anyone with the view's address pause, stop and change the mission")
      ->needs(view);
  run->add_flag(
      "--urgent", o->urgent,
      "Raise the launcher's priority (niceness -10, for root), for hundreds of processes");
  run->add_flag("--json", o->json, "Print the summary as JSON");
  return {run, [o] { return run_mission(*o); }};
}

}  // namespace swarm::launcher::cli
