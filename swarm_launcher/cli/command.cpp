// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/command.hpp"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "swarm_launcher/cli/commands.hpp"

namespace swarm::launcher::cli {

// The command and its keys are joined by blanks and sent to the launcher of the run as one line.
Command add_command(CLI::App& program) {
  struct Options {
    std::filesystem::path run_dir;
    std::vector<std::string> arguments;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* const command = program.add_subcommand(
      "command",
      "Command a running mission: start, pause, resume, stop (an emergency stop), or a change:\n"
      "  add_obstacle 'circle_m: {center: [100, 60], radius: 4}'    (or polygon_m: [[x, y], "
      "...])\n"
      "  move_obstacle 'obstacle: 6, by_m: [10, 0], over_s: 20'\n"
      "  remove_obstacle 'obstacle: 6'\n"
      "  goto 'goal: [{mean_m: [20, 20], covariance_m2: [[9, 0], [0, 9]], weight: 1}]'\n"
      "  risk 'alpha: 0.15'\n"
      "  clear 7    (the body of robot 7, which is not received any more, was carried away)");
  command->add_option("run_dir", o->run_dir, "Its run directory")->required()->type_name("RUN_DIR");
  command->add_option("arguments", o->arguments, "The command and its keys, as in a mission script")
      ->required()
      ->type_name("COMMAND [KEYS]");
  return {command, [o] {
            return command_mission(o->run_dir, fmt::format("{}", fmt::join(o->arguments, " ")));
          }};
}

}  // namespace swarm::launcher::cli
