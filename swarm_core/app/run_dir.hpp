// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::shell {

/// Makes the directory of a run with its folders and returns its absolute path. An empty `out`
/// stands for runs/<mission>-<time>. Refuses a directory that holds a run already.
Result<std::filesystem::path> make_run_dir(const std::filesystem::path& out,
                                           const std::string& mission);

}  // namespace swarm::shell
