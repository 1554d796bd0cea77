// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/plan.hpp"

#include <memory>

#include "swarm_launcher/cli/commands.hpp"

namespace swarm::launcher::cli {

// The table of --times is part of the text: --json omits it.
Command add_plan(CLI::App& program) {
  const auto o = std::make_shared<PlanCommandOptions>();
  CLI::App* const plan = program.add_subcommand("plan", "Plan a mission without moving a robot");
  plan->add_option("mission", o->mission_file, "Mission file")
      ->required()
      ->type_name("MISSION.yaml");
  plan->add_option("--seed", o->seed, "First seed (default: 1)");
  plan->add_option("--repeat", o->repeat, "Number of seeds, one plan each (default: 1)")
      ->check(CLI::Range(1, 100000));
  plan->add_option("--out", o->out, "Directory for plan.json and plan.svg");
  plan->add_flag("--json", o->json, "Print the result as JSON");
  plan->add_flag("--times", o->times,
                 "Print when the groups of the first plan pass its narrowest place");
  return {plan, [o] { return plan_mission(*o); }};
}

}  // namespace swarm::launcher::cli
