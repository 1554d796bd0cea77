// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// `swarm_launcher simulate` is this program.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "swarm_core/app/program.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "swarm_sim/simulate.hpp"

namespace swarm::launcher {
namespace {

/// The options as parsed; --fault and --kill are still texts.
struct CommandLine {
  SimulateOptions options;
  std::string fault;
  std::vector<std::string> kills;
};

void add_options(CLI::App& app, const std::shared_ptr<CommandLine>& line) {
  constexpr int kMostSimulated = 200'000;
  SimulateOptions* const o = &line->options;
  app.add_option("mission", o->mission_file, "Mission file")->required()->type_name("MISSION.yaml");
  app.add_option("--robots", o->robots, "Number of robots, instead of the mission's")
      ->check(CLI::Range(1, kMostSimulated));
  app.add_option("--seed", o->seed,
                 "Seed of placement, plan, robots, faults and kills (default: 1)");
  app.add_option("--fault", line->fault,
                 "Degrades what is received:\nloss=0.2,delay-ms=150,jitter-ms=50,from=10,to=60")
      ->type_name("FAULT");
  app.add_option("--kill", line->kills,
                 "Robots die and their bodies stay: N@SECONDS, N robots drawn by the seed,\n"
                 "N@SECONDS,in=X0:Y0:X1:Y1, drawn from those in a box (metres), "
                 "or\nids:A,B@SECONDS; repeatable")
      ->allow_extra_args(false)
      ->type_name("KILL");
  app.add_flag_callback(
      "--clocks-apart", [o] { o->clocks_in_step = false; },
      "Robots tick at different moments of the control period (default: at the same)");
  app.add_option("--threads", o->threads, "Number of threads; 0: chosen automatically (default: 0)")
      ->check(CLI::Range(0, 256));
  app.add_flag_callback(
      "--no-record", [o] { o->record = false; },
      "Write no robot logs, audit and report; print only arrivals and times");
  app.add_option("--out", o->out, "Run directory (default: runs/<mission>-<time>)");
  app.add_flag("--json", o->json, "Print the summary as JSON");
}

/// Parses faults and kills here, so that their errors name the text that is wrong.
Result<ExitCode> simulate(CommandLine& line) {
  const auto faults = parse_link_faults(line.fault);
  if (!faults) return tl::unexpected(faults.error());
  if (faults->duplicate > 0.0 || faults->at_launcher || !faults->at_planner()) {
    return fail(
        ErrorCode::kBadInput,
        "--fault: duplicate, robots and launcher are for runs of processes; here all robots "
        "receive by the same network");
  }
  line.options.faults = *faults;
  for (const std::string& text : line.kills) {
    auto kill = parse_kill(text);
    if (!kill) return tl::unexpected(kill.error());
    line.options.kills.push_back(*std::move(kill));
  }
  return simulate_mission(line.options);
}

}  // namespace
}  // namespace swarm::launcher

int main(int argc, char** argv) {
  using namespace swarm;
  const std::string name = shell::program_name(argv[0], "swarm_sim");
  return shell::run_main(name, [&]() -> Result<ExitCode> {
    CLI::App app(
        "Simulates a mission in one process, as fast as the machine allows: the same planner,\n"
        "supervisor and robot loop as in a run, with all robots ticking in lock-step",
        name);
    shell::add_common_options(app);
    const auto line = std::make_shared<launcher::CommandLine>();
    launcher::add_options(app, line);
    const auto done = shell::parse(app, argc, argv, builtin_catalogue());
    if (!done) return tl::unexpected(done.error());
    if (*done) return **done;
    shell::catch_stop_signals(shell::Hangup::kStop);
    return launcher::simulate(*line);
  });
}
