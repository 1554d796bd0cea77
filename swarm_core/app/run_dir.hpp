// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::shell {

/// Makes a directory and returns its absolute path. An empty `out` stands for
/// runs/<mission>-<time>, or -2, -3 … behind it: each caller gets a directory of its own, also
/// among processes that start at the same moment. Refuses a directory that holds a run already, and
/// one that another process has claimed and not given back by its end.
Result<std::filesystem::path> claim_dir(const std::filesystem::path& out,
                                        const std::string& mission);

/// claim_dir() for a run: with its folders.
Result<std::filesystem::path> make_run_dir(const std::filesystem::path& out,
                                           const std::string& mission);

/// Whether the process that made the directory of a run, its launcher as a rule, still runs.
bool is_run_alive(const std::filesystem::path& run_dir);

}  // namespace swarm::shell
