// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/check_driver.hpp"

#include <memory>

#include "swarm_launcher/cli/commands.hpp"

namespace swarm::launcher::cli {

Command add_check_driver(CLI::App& program) {
  const auto o = std::make_shared<CheckDriverOptions>();
  CLI::App* const check =
      program.add_subcommand("check-driver",
                             "Drive one robot about, alone, and check its driver against the "
                             "contract (a minute and a half)");
  check->add_option("mission", o->mission_file, "Mission file")
      ->required()
      ->type_name("MISSION.yaml");
  check->add_option("--robot", o->robot, "Number of the robot (default: 0)");
  check->add_option("--agent-program", o->agent_program,
                    "Robot program that has the driver (default: robot_agent)");
  // For the robot program, which has the same options.
  const auto pass_on = [o, check](const std::string& name, const std::string& help) {
    return check->add_option_function<std::string>(
        name,
        [o, name](const std::string& value) {
          o->more.insert(o->more.end(), {name, value});
        },
        help);
  };
  pass_on("--room-m", "Free space around the robot, half a side of a square (default: 2)")
      ->check(CLI::Range(0.1, 100.0));
  pass_on("--speed-mps", "Its speed (default: 0.3)")->check(CLI::Range(0.01, 100.0));
  pass_on("--cut-pose",
          "Command that takes its localisation away (called with `cut`) and gives it back "
          "(`restore`)");
  const auto pass_flag_on = [o, check](const std::string& name, const std::string& help) {
    check->add_flag_callback(
        name, [o, name] { o->more.push_back(name); }, help);
  };
  pass_flag_on("--may-kill", "Cut its motors at the end");
  pass_flag_on("--json", "Print the result as JSON");
  return {check, [o] { return check_driver(*o); }};
}

}  // namespace swarm::launcher::cli
