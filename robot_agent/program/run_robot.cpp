// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/run_robot.hpp"

#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>

#include "robot_agent/program/agent_process.hpp"
#include "robot_agent/program/driver_check_program.hpp"
#include "robot_drivers/ros/ros_driver.hpp"
#include "swarm_core/app/program.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/app/vendor_option.hpp"

namespace swarm::agent {
namespace {

/// The options as parsed, before they are checked.
struct CommandLine {
  ProcessOptions options;
  std::uint32_t first = 0;
  std::string fault;
  bool describe = false;
  DriverCheckRequest check;
};

/// Of --check-driver, which `swarm_launcher check-driver` calls.
void add_check_options(CLI::App& app, DriverCheckRequest& check) {
  app.add_option("--check-driver", check.mission,
                 "Check the driver of robot --ids of this mission against its contract, and exit");
  app.add_option("--room-m", check.room_m, "Its room: half a side of a square (default: 2)")
      ->check(CLI::Range(0.1, 100.0));
  app.add_option("--speed-mps", check.speed_mps, "Its speed (default: 0.3)")
      ->check(CLI::Range(0.01, 100.0));
  app.add_flag("--may-kill", check.may_kill, "Cut its motors at the end");
  app.add_option("--cut-pose", check.cut_pose,
                 "Command that takes its localisation away (called with `cut`) and gives it back "
                 "(`restore`)");
  app.add_flag("--json", check.json, "Print the result as JSON");
}

void add_options(CLI::App& app, CommandLine& line) {
  app.add_option("--run", line.options.run_dir, "Run directory made by the launcher");
  app.add_option("--inputs", line.options.inputs,
                 "Run and mission in one file; without it those of the run directory");
  app.add_option("--steps", line.options.steps,
                 "Memory in which the launcher finds the robots' last control steps");
  app.add_option("--ids", line.first,
                 "Id of the first robot of this process; it hosts the ids that follow");
  app.add_option("--count", line.options.count, "Number of robots in this process (default: 1)");
  app.add_option("--number", line.options.number, "Number of this agent process, from 0");
  app.add_option("--parent", line.options.parent_pid,
                 "End when this process is no longer the parent");
  shell::add_vendor_option(app, line.options.vendor, "DDS vendor of this process");
  app.add_flag("--by-gateway", line.options.by_gateway,
               "Publish states on DDS topics; a gateway carries them to the multicast groups");
  app.add_option(
      "--fault", line.fault,
      "Degrades what this process receives:\n"
      "loss=0.2,delay-ms=150,jitter-ms=50,duplicate=0.1,from=10,to=60,robots=3-5,launcher=1");
  app.add_flag("--describe", line.describe,
               "Print its control methods and drivers with their options as JSON, and exit");
  add_check_options(app, line.check);
  shell::add_common_options(app);
}

/// --describe works without a run: the launcher calls it to learn what methods and drivers a
/// program has.
Result<ExitCode> run(int argc, char** argv, const RobotRegistry& registry) {
  CLI::App app(
      "Moves one robot (or several) of a run, by the plan, the map and the neighbours' states "
      "that it receives.\nThe launcher starts it; to start one by hand: "
      "robot_agent --run RUN_DIR --ids 7",
      "robot_agent");
  CommandLine line;
  add_options(app, line);
  const auto done = shell::parse(app, argc, argv, catalogue_of(registry));
  if (!done) return tl::unexpected(done.error());
  if (*done) return **done;
  if (line.describe) {
    std::puts(to_json(catalogue_of(registry)).c_str());
    return ExitCode::kOk;
  }
  if (app.count("--check-driver") > 0) {
    line.check.robot = line.first;
    return run_driver_check(line.check, registry);
  }
  // Not required() of the parser, as --describe needs neither.
  if (app.count("--run") == 0 || app.count("--ids") == 0) {
    return fail(ErrorCode::kBadInput, "--run and --ids are required; the launcher gives both");
  }
  const auto faults = parse_link_faults(line.fault);
  if (!faults) return tl::unexpected(faults.error());
  if (faults->at_robots(line.first, line.options.count)) {
    line.options.faults = *faults;
  }
  line.options.first = RobotId(line.first);

  shell::catch_stop_signals();
  const auto process = AgentProcess::make(line.options, registry);
  if (!process) return tl::unexpected(process.error());
  if (const auto ran = (*process)->run(); !ran) return tl::unexpected(ran.error());
  return ExitCode::kOk;
}

}  // namespace

RobotRegistry builtin_robots() {
  RobotRegistry registry;
  register_builtin_control(registry.control);
  register_builtin_drivers(registry.drivers);
  drivers::register_ros_driver(registry.drivers);
  return registry;
}

int run_robot(int argc, char** argv, const RobotRegistry& registry) {
  return shell::run_main("robot_agent", [&] { return run(argc, argv, registry); });
}

}  // namespace swarm::agent
