// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/command.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "swarm_launcher/cli/commands.hpp"
#include "swarm_launcher/commands/stop_robots.hpp"

namespace swarm::launcher::cli {

// The command and its keys are joined by blanks and sent to the launcher of the run as one line.
Command add_command(CLI::App& program) {
  struct Options {
    std::filesystem::path run_dir;
    std::vector<std::string> arguments;
    std::optional<std::uint32_t> domain;
    std::string interface = "127.0.0.1";
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
  command->add_option("run_dir", o->run_dir, "Its run directory; left out with --domain")
      ->required()
      ->type_name("RUN_DIR");
  command->add_option("arguments", o->arguments, "The command and its keys, as in a mission script")
      ->type_name("COMMAND [KEYS]");
  command->add_option("--domain", o->domain,
                      "Stop all robots of a DDS domain, without a run directory: --domain N stop")
      ->check(CLI::Range(0, 229));
  command->add_option("--interface", o->interface, "IPv4 address of the interface, with --domain")
      ->check(CLI::ValidIPV4);
  return {command, [o]() -> Result<ExitCode> {
            if (o->domain) {
              if (o->run_dir != "stop" || !o->arguments.empty()) {
                return fail(ErrorCode::kBadInput, "--domain: the only command is stop");
              }
              return stop_domain(*o->domain, o->interface);
            }
            if (o->arguments.empty()) return fail(ErrorCode::kBadInput, "COMMAND is required");
            return command_mission(o->run_dir, fmt::format("{}", fmt::join(o->arguments, " ")));
          }};
}

}  // namespace swarm::launcher::cli
