// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "swarm_launcher/processes/spawner.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Requests a higher priority for this process (granted to root; others continue without). The
/// discovery server runs in this process: if hundreds of starting agents leave it without CPU time,
/// it answers late, agents repeat their requests, and it never catches up. Call it before any
/// thread is started.
void become_urgent();

/// Starts a program with stdout and stderr appended to `log`. The child
///  - is in a process group of its own, so that Ctrl-C at the terminal reaches the launcher alone,
///  - gets SIGTERM from the kernel when the launcher dies, so that no process is orphaned,
///  - has a lower priority than the launcher (5 more niceness), which must get CPU time beside
///    hundreds of them,
///  - is ended by the kernel before the launcher when memory runs out (oom_score_adj 500),
///  - has no file or socket of the launcher.
/// Without its log it runs all the same, and a line on stderr reports it.
/// Call it from a thread that runs as long as the launcher: the kernel monitors that thread.
Result<pid_t> start_process(const std::vector<std::string>& command_line,
                            const std::filesystem::path& log);

/// The kernel's number of a signal.
int number_of(EndSignal signal);

/// The next child that has ended, if any; never blocks.
std::optional<ExitedChild> reap_child();

/// Real processes.
class ChildSpawner final : public Spawner {
 public:
  /// As start_process(), including its demand on the calling thread.
  Result<pid_t> start(const std::vector<std::string>& command_line,
                      const std::filesystem::path& log) override {
    return start_process(command_line, log);
  }
  std::optional<ExitedChild> reap() override { return reap_child(); }
  void signal(pid_t pid, EndSignal signal) override;
};

/// Path of a program that lies beside the running one, e.g. "robot_agent".
std::filesystem::path sibling_program(const std::string& name);

/// `chosen`, or the program of this name that lies beside the running one if that is empty.
inline std::filesystem::path program_or(const std::filesystem::path& chosen,
                                        const std::string& name) {
  return chosen.empty() ? sibling_program(name) : chosen;
}

}  // namespace swarm::launcher
