// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/command.hpp"

#include <cstdio>

#include "swarm_core/app/control_socket.hpp"
#include "swarm_launcher/commands/stop_robots.hpp"

namespace swarm::launcher {

// The launcher answers in lines; each is printed as it arrives.
Result<ExitCode> command_mission(const std::filesystem::path& run_dir, const std::string& line) {
  if (line == "stop") return stop_run(run_dir);
  const auto done = shell::send_command(
      run_dir, line, [](const std::string& answer) { std::printf("%s\n", answer.c_str()); });
  if (!done) return tl::unexpected(done.error());
  return *done ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
}

}  // namespace swarm::launcher
