// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "swarmflow/core/result.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {

/// Asks for a higher priority of this process (root gets it, others go on without): the discovery
/// server lives here, and one that is starved by hundreds of starting agents answers late, is asked
/// again, and never catches up. Call it before any thread is started.
void become_urgent();

/// Starts a program with stdout and stderr appended to `log`. The child
///  - is in a process group of its own, so that Ctrl-C at the terminal reaches the launcher alone,
///  - is given to end (SIGTERM) by the kernel when the launcher dies, so that nothing is orphaned,
///  - is a little less urgent than the launcher (nice 5), which must not be starved by hundreds of
///  them.
/// Call it from the thread that lives as long as the launcher: the kernel watches that thread.
Result<pid_t> start_process(const std::vector<std::string>& command_line,
                            const std::filesystem::path& log);

/// The kernel's number of a signal.
int number_of(EndSignal signal);

struct ExitedChild {
  pid_t pid = 0;
  ProcessExit exit;
  double cpu_s = 0.0;  ///< user + system
  double max_rss_mb = 0.0;
};

/// The next child that has ended, if any; never blocks.
std::optional<ExitedChild> reap_child();

/// Path of a program that lies beside the running one, e.g. "robot_agent".
std::filesystem::path sibling_program(const std::string& name);

/// `chosen`, or the program of this name that lies beside the running one if that is empty.
inline std::filesystem::path program_or(const std::filesystem::path& chosen,
                                        const std::string& name) {
  return chosen.empty() ? sibling_program(name) : chosen;
}

}  // namespace swarm::launcher
