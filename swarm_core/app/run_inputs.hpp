// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "swarm_core/app/run_directory.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::shell {

/// What planner and agents read before they join a run.
struct RunInputs {
  RunInfo run;
  Mission mission;
};

/// Both as one document, in which read_run_inputs() finds them. The launcher keeps it in memory: a
/// process can be started, too, when the run directory is full or gone.
std::string to_json(const RunInfo& run, const std::string& mission_yaml);

/// Reads the document `inputs`, or, without its name, the files of the run directory. kBadInput if
/// they cannot be read or the mission is wrong.
Result<RunInputs> read_run_inputs(const std::filesystem::path& run_dir,
                                  const std::filesystem::path& inputs, const Catalogue& catalogue);

}  // namespace swarm::shell
