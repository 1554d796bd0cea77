// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/command.hpp"

#include <algorithm>
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
namespace {

/// What a user may send. The launcher refuses `add_body` itself, which only its scene log holds.
const std::vector<std::string> kCommands{"start",        "pause",         "resume",          "stop",
                                         "add_obstacle", "move_obstacle", "remove_obstacle", "goto",
                                         "risk",         "clear"};

/// Fails (kBadInput) with the list of commands if a line begins with none of them.
Result<void> check_command(const std::string& line) {
  const std::string name = line.substr(0, line.find(' '));
  const bool known = std::find(kCommands.begin(), kCommands.end(), name) != kCommands.end();
  if (known || name == "add_body") return {};
  return fail(ErrorCode::kBadInput, fmt::format("unknown command {}; must be one of {}", name,
                                                fmt::join(kCommands, ", ")));
}

}  // namespace

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
      "Command a mission in progress: start, pause, resume, stop (an emergency stop, final), or\n"
      "change its map or goal:\n"
      "  add_obstacle 'circle_m: {center: [100, 60], radius: 4}'    (or polygon_m: [[x, y], "
      "...])\n"
      "  move_obstacle 'obstacle: 6, by_m: [10, 0], over_s: 20'\n"
      "  remove_obstacle 'obstacle: 6'\n"
      "  goto 'goal: [{mean_m: [20, 20], covariance_m2: [[9, 0], [0, 9]], weight: 1}]'\n"
      "  risk 'alpha: 0.15'\n"
      "  clear 7    (removes robot 7's body from the map, after someone carried it away)");
  command->add_option("run_dir", o->run_dir, "Run directory of the mission; none with --domain")
      ->required()
      ->type_name("RUN_DIR");
  command->add_option("arguments", o->arguments, "The command and its keys, as in a mission script")
      ->type_name("COMMAND [KEYS]");
  command
      ->add_option("--domain", o->domain,
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
            const std::string line = fmt::format("{}", fmt::join(o->arguments, " "));
            if (auto known = check_command(line); !known) return tl::unexpected(known.error());
            return command_mission(o->run_dir, line);
          }};
}

}  // namespace swarm::launcher::cli
