// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

#include "swarm_core/mission/vendor.hpp"
#include "swarm_launcher/hosts/offer.hpp"
#include "swarm_launcher/hosts/start_queue.hpp"
#include "swarm_launcher/processes/child_process.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

struct HostProcessesOptions {
  std::filesystem::path dir;  ///< of the run
  std::string steps;          ///< path of the memory for the robots' last steps
  std::string inputs;         ///< path of the memory with run and mission
  link::Vendor dds = link::Vendor::kFastDds;
  std::uint32_t respawns = 0;  ///< see StartQueue
};

/// The agent processes of a joined host: started and restarted by a StartQueue, and killed when the
/// object is destroyed. One thread.
class HostProcesses {
 public:
  /// The offer outlives the object.
  HostProcesses(const HostOffer& offer, HostProcessesOptions options);
  ~HostProcesses() { signal(SIGKILL); }
  HostProcesses(const HostProcesses&) = delete;
  HostProcesses& operator=(const HostProcesses&) = delete;

  /// Reaps processes that ended, queues their restarts, and starts the next process that is due.
  /// One that cannot be started, as memory is short, counts as ended.
  void step();

  /// Numbers of the processes that have ended since the last call, counted from our first.
  std::vector<std::pair<std::uint32_t, ProcessExit>> take_exits() {
    return std::exchange(exits_, {});
  }

  /// Kills processes that make no steps, by their numbers counted from our first, except those that
  /// have been started within the last half minute: they may still be joining the bus. Kills none
  /// if they are more than half of several: then the machine is overloaded.
  void kill_hung(const std::set<std::uint32_t>& processes);

  /// From the first signal on no process is started or restarted.
  void signal(int number);

  /// All processes have ended and none is to be started.
  bool over() const { return children_.empty() && (ending_ || queue_.is_empty()); }
  std::size_t living() const { return children_.size(); }

 private:
  Result<void> start(std::uint32_t robot);

  const HostOffer& offer_;
  HostProcessesOptions options_;
  StartQueue queue_;
  struct Child {
    std::uint32_t robot = 0;  ///< its first one, counted from our first
    SteadyTime started_at;
  };
  std::map<pid_t, Child> children_;
  std::vector<std::pair<std::uint32_t, ProcessExit>> exits_;
  bool ending_ = false;
};

}  // namespace swarm::launcher
