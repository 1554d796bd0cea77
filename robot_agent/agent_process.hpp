// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "swarm_core/base/ids.hpp"
#include "swarm_core/base/result.hpp"
#include "swarm_core/mission/link_faults.hpp"
#include "swarm_link/vendor.hpp"

namespace swarm::agent {

struct ProcessOptions {
  std::filesystem::path run_dir;
  RobotId first;  ///< the robots first … first + count − 1 live in this process
  std::uint32_t count = 1;
  std::uint32_t number = 0;  ///< of this process among the agents of the run
  LinkFaults faults{};
  link::Vendor vendor = link::Vendor::kFastDds;
  bool by_gateway = false;       ///< its states go by topics where the others' go by groups
  std::uint32_t parent_pid = 0;  ///< end when this process is gone; 0 = do not watch
};

/// The program: one participant, its robots' bodies, black boxes and control loop.
///
/// Each robot decides alone, from what it hears on the bus, also of robots in the same process;
/// they share the participant, the readers and the clock, nothing else.
class AgentProcess {
 public:
  static Result<std::unique_ptr<AgentProcess>> make(const ProcessOptions& options);
  ~AgentProcess();

  /// Runs until a stop signal, the end of the parent, or the end of the process's robots.
  Result<void> run();

 private:
  struct Impl;
  explicit AgentProcess(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace swarm::agent
