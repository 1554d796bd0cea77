// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::monitor {

/// Counters of a merge; `boxes` are robot logs.
struct MergeResult {
  std::filesystem::path file{};
  std::uint64_t messages = 0;
  std::uint32_t boxes = 0;       ///< that could be read
  std::uint32_t unended = 0;     ///< files whose writers were killed
  std::uint64_t damaged = 0;     ///< stretches of bytes that are not records
  std::uint64_t lost = 0;        ///< records that the numbering of the robot logs lacks
  std::uint32_t recordings = 0;  ///< of the bus
};

/// Makes one recording of a run: all robot logs and recordings of the bus in the order of time,
/// with mission, plans, scene, events and summary attached. `out` empty: recording.mcap in the run
/// directory. `progress` receives the share that is written. Memory: about the size of the input.
Result<MergeResult> merge_run(const std::filesystem::path& run_dir,
                              const std::filesystem::path& out,
                              const std::function<void(double)>& progress = {});

std::string to_json(const MergeResult& result);

}  // namespace swarm::monitor
