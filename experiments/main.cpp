// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// `swarm_launcher table`, `soak` and `chaos` start this program.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "experiments/chaos/chaos.hpp"
#include "experiments/papers/table.hpp"
#include "experiments/soak/soak.hpp"
#include "swarm_core/app/program.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_launcher/cli/shared_options.hpp"
#include "swarm_launcher/processes/builtin_catalogue.hpp"

namespace swarm::launcher {
namespace {

/// The action of a subcommand, run after its options are parsed.
using Act = std::function<Result<ExitCode>()>;

/// The returned action owns the options that the parser fills.
Act add_table(CLI::App& program) {
  const auto o = std::make_shared<TableOptions>();
  CLI::App* const table = program.add_subcommand(
      "table", "Simulate the experiments of a paper; prints the paper's numbers beside ours");
  table
      ->add_option(
          "which", o->which,
          "The paper; diffusion_fine: thousands of robots of 1 cm; network: effect of loss,\n"
          "delay, noise and clocks out of step")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>(kTables.begin(), kTables.end())));
  table->add_flag("--quick", o->quick, "Fewer robots and seeds");
  table->add_option("--missions", o->missions,
                    "Directory of the mission files (default: deploy/missions)");
  table->add_option("--out", o->out, "Directory for the table (Markdown, JSON) and figures");
  return [o] { return make_table(*o); };
}

void add_limits(CLI::App& app, SoakCriteria& criteria) {
  struct Limit {
    const char* option;
    std::optional<double> SoakCriteria::*limit;
    const char* doc;
  };
  constexpr Limit kLimits[] = {
      {"--max-p99-ms", &SoakCriteria::max_p99_ms,
       "Fail if 1 % of the states take longer to a receiver"},
      {"--max-loss", &SoakCriteria::max_loss,
       "Fail if a larger share of the states is lost, 0 to 1"},
      {"--max-rss-growth-pct", &SoakCriteria::max_rss_growth_pct,
       "Fail if the agents' memory grows by more"},
      {"--max-late-pct", &SoakCriteria::max_late_pct,
       "Fail if more control periods begin late or are missed"},
      {"--max-status-ms", &SoakCriteria::max_status_ms,
       "Fail if 1 % of the statuses take longer to the launcher"},
      {"--max-command-ms", &SoakCriteria::max_command_ms,
       "Fail if 1 % of the robots report later that they obey a command"},
      {"--max-plan-ms", &SoakCriteria::max_plan_ms,
       "Fail if 1 % of the robots report later that they follow the plan of a scene"},
      {"--max-beat-ms", &SoakCriteria::max_beat_ms,
       "Fail if the planner's heartbeats have a longer gap"},
      {"--max-clock-error-ms", &SoakCriteria::max_clock_error_ms,
       "Fail if statuses show a larger error between clocks"}};
  for (const Limit& limit : kLimits) app.add_option(limit.option, criteria.*limit.limit, limit.doc);
}

/// Limits of the result are options as well: a soak is a test with an exit code.
Act add_soak(CLI::App& program) {
  using namespace cli;
  const auto o = std::make_shared<SoakOptions>();
  CLI::App* const soak_app = program.add_subcommand(
      "soak", "Keep a swarm moving; measure latency, loss, memory and late ticks");
  soak_app->add_option("--processes", o->processes, "Number of agent processes (default: 100)")
      ->check(CLI::Range(1, kMostRobots));
  soak_app->add_option("--per-process", o->per_process, "Robots hosted by each (default: 1)")
      ->check(CLI::Range(1, kMostRobots));
  soak_app->add_option("--rate-hz", o->rate_hz, "Control rate (default: 10)")
      ->check(CLI::Range(1.0, 100.0));
  soak_app->add_option("--duration-s", o->duration_s, "How long robots move (default: 60)")
      ->check(CLI::Range(5.0, 1e6));
  add_channel(*soak_app, o->channel);
  soak_app
      ->add_option("--fault", o->fault,
                   "Degrades what is "
                   "received:\nloss=0.2,delay-ms=150,jitter-ms=50,duplicate=0.1,from=10,to=60,"
                   "robots=3-5,launcher=1")
      ->type_name("FAULT");
  add_limits(*soak_app, o->criteria);
  soak_app->add_flag("--flat", o->criteria.is_flat,
                     "Fail if threads or open files grow by more than 1 %");
  soak_app->add_option("--seed", o->seed, "Seed of placement, plan and robots (default: 1)");
  soak_app->add_option("--out", o->out, "Run directory (default: runs/soak-<time>)");
  add_domain(*soak_app, o->domain);
  soak_app->add_flag("--urgent", o->urgent,
                     "Raise the launcher's priority (niceness -10, for root)");
  soak_app->add_flag("--json", o->json, "Print the result as JSON");
  return [o] { return soak(*o); };
}

Act add_chaos(CLI::App& program) {
  using namespace cli;
  const auto o = std::make_shared<ChaosOptions>();
  CLI::App* const chaos_app = program.add_subcommand(
      "chaos", "Fly a mission again and again under random faults; audit each flight");
  chaos_app->add_option("mission", o->mission, "Mission file")->required();
  chaos_app
      ->add_option("--minutes", o->minutes,
                   "No flight begins later (default: 5); 0: one flight, to repeat a failure")
      ->check(CLI::Range(0.0, 1e5));
  chaos_app->add_option("--robots", o->robots, "Number of robots, instead of the mission's")
      ->check(CLI::Range(1, kMostRobots));
  chaos_app->add_option("--seed", o->seed,
                        "Seed of the first flight and its faults (default: 1); +1 a flight");
  chaos_app->add_option("--out", o->out, "Directory of the flights (default: runs/chaos-<time>)");
  chaos_app->add_flag("--json", o->json, "Print the result as JSON");
  return [o] { return chaos(*o); };
}

}  // namespace
}  // namespace swarm::launcher

int main(int argc, char** argv) {
  using namespace swarm;
  const std::string name = shell::program_name(argv[0], "swarm_experiments");
  return shell::run_main(name, [&]() -> Result<ExitCode> {
    CLI::App app("Simulates the experiments of the papers, and runs endurance tests (soak, chaos)",
                 name);
    app.require_subcommand(1);
    shell::add_common_options(app);
    const launcher::Act table = launcher::add_table(app);
    const launcher::Act soak = launcher::add_soak(app);
    const launcher::Act chaos = launcher::add_chaos(app);
    const auto done = shell::parse(app, argc, argv, builtin_catalogue());
    if (!done) return tl::unexpected(done.error());
    if (*done) return **done;
    shell::catch_stop_signals(shell::Hangup::kStop);
    if (app.got_subcommand("table")) return table();
    return app.got_subcommand("chaos") ? chaos() : soak();
  });
}
