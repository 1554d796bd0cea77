// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "swarm_link/stream_meter.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::monitor {

struct RecordOptions {
  std::filesystem::path run_dir;
  std::filesystem::path out{};             ///< empty: bus.mcap in the run directory
  std::optional<double> duration_s{};      ///< empty: until the run ends
  std::function<bool()> stop_requested{};  ///< asked every few milliseconds
};

/// Counters of a recording.
struct RecordResult {
  std::filesystem::path file{};
  std::uint64_t messages = 0;
  std::uint64_t dropped = 0;            ///< messages that the disk did not take
  link::StreamMeter::Counts states{};   ///< lost: by their numbers
  std::vector<std::uint64_t> by_topic;  ///< as recorded_topics()
};

/// Records the bus of a run. Messages are on the disk at most a second after their reception.
/// `mission.yaml` of the run is attached, so that the recording can be replayed by itself.
Result<RecordResult> record_bus(const RecordOptions& options);

std::string to_json(const RecordResult& result);

}  // namespace swarm::monitor
