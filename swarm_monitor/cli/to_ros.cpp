// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "swarm_core/app/stop_signal.hpp"
#include "swarm_monitor/cli/commands.hpp"
#include "swarm_monitor/ros/publish_to_ros.hpp"

namespace swarm::monitor::cli {
namespace {

struct RosCommandLine {
  std::filesystem::path run_dir;
  RosOutput output;
};

/// Ends with the run, or at a stop signal.
Result<ExitCode> publish(const RosCommandLine& line) {
  if (auto joinable = check_in_progress(line.run_dir); !joinable) {
    return tl::unexpected(joinable.error());
  }
  shell::catch_stop_signals(shell::Hangup::kStop);
  const auto go_on = [&] { return shell::stop_requests() == 0 && is_in_progress(line.run_dir); };
  const auto done = publish_to_ros(line.run_dir, line.output, go_on);
  if (!done) return tl::unexpected(done.error());
  return ExitCode::kOk;
}

}  // namespace

Command add_ros(CLI::App& program) {
  const auto o = std::make_shared<RosCommandLine>();
  CLI::App* const command = program.add_subcommand(
      "ros", "Publish a run in progress to ROS 2: poses, markers, map, diagnostics");
  command->add_option("run_dir", o->run_dir, "Run directory of a run in progress")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->type_name("RUN_DIR");
  command->add_option("--namespace", o->output.name_space,
                      "Namespace of its topics (default: swarm)");
  command->add_option("--frame", o->output.frame, "frame_id of its messages (default: map)");
  command->add_option("--rate-hz", o->output.rate_hz, "Rate of poses and markers (default: 10)")
      ->check(CLI::Range(0.1, 50.0));
  command
      ->add_option("--resolution-m", o->output.resolution_m, "Side of a map's cell (default: 0.1)")
      ->check(CLI::Range(0.001, 1000.0));
  command->footer(
      "The ROS domain is that of the environment (ROS_DOMAIN_ID and so on).\n"
      "`true` on /NAMESPACE/emergency_stop (std_msgs/Bool) stops the robots.");
  return {command, [o] { return publish(*o); }};
}

}  // namespace swarm::monitor::cli
