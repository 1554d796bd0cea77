// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/soak/soak.hpp"

#include <memory>

#include "swarm_launcher/cli/commands.hpp"

namespace swarm::launcher::cli {

Command add_soak(CLI::App& program) {
  const auto o = std::make_shared<SoakOptions>();
  CLI::App* const soak_app = program.add_subcommand(
      "soak", "Keep a swarm moving, and measure what its link and its processes do");
  soak_app->add_option("--processes", o->processes, "Number of agent processes")
      ->check(CLI::Range(1, kMostRobots));
  soak_app->add_option("--per-process", o->per_process, "Robots hosted by each")
      ->check(CLI::Range(1, kMostRobots));
  soak_app->add_option("--rate-hz", o->rate_hz, "Control rate")->check(CLI::Range(1.0, 100.0));
  soak_app->add_option("--duration-s", o->duration_s, "How long robots move")
      ->check(CLI::Range(5.0, 1e6));
  add_channel(*soak_app, o->channel);
  soak_app->add_option("--fault", o->fault, "A bad network, as for run")->type_name("FAULT");
  soak_app->add_option("--max-p99-ms", o->criteria.max_p99_ms,
                       "Fail if 1 % of states take longer to a listener");
  soak_app->add_option("--max-loss", o->criteria.max_loss,
                       "Fail if a larger share of states is lost");
  soak_app->add_option("--max-rss-growth-pct", o->criteria.max_rss_growth_pct,
                       "Fail if the agents' memory grows by more");
  soak_app->add_option("--seed", o->seed, "Seed of placement, plan and robots");
  soak_app->add_option("--out", o->out, "Run directory (default: runs/soak-<time>)");
  add_domain(*soak_app, o->domain);
  soak_app->add_flag("--json", o->json, "Print the result as JSON");
  return {soak_app, [o] { return soak(*o); }};
}

}  // namespace swarm::launcher::cli
