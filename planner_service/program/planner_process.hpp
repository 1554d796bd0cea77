// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "swarm_core/mission/link_faults.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/planning/planning_registry.hpp"

namespace swarm::planner {

/// Options of the command line.
struct ProcessOptions {
  std::filesystem::path run_dir;
  std::filesystem::path inputs{};  ///< see shell::read_run_inputs(); empty: those of run_dir
  LinkFaults faults{};
  std::uint32_t parent_pid = 0;  ///< end when this process has ended; 0 = do not watch
};

/// The program: plans, publishes the plan (kept for late joiners) and the heartbeat, and follows
/// the mission's commands for its clock t0. When the scene changes it plans anew from the positions
/// that the robots report. The same mission and seed give the same first plan, so after a restart
/// in an unchanged scene it publishes the same flow under a higher epoch and the swarm goes on
/// where it was; in a changed one it plans anew. A thread of its own writes its files: robots wait
/// for no disk. It keeps the files of the first plan and of the newest hundred.
class PlannerProcess {
 public:
  /// Plans first, joins the bus second: a mission that cannot be planned ends here, with the reason
  /// as error.
  static Result<std::unique_ptr<PlannerProcess>> make(const ProcessOptions& options,
                                                      const PlanningRegistry& registry);
  ~PlannerProcess();

  /// Runs until a stop signal or the end of the parent.
  Result<void> run();

 private:
  struct Impl;
  explicit PlannerProcess(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace swarm::planner
