// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "swarm_core/robot_log/format.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::monitor {

/// A topic as recordings have it.
struct RecordedTopic {
  std::string name{};  ///< "swarm/plan"
  mcap::Schema schema{};
};

/// All topics that a recording of the bus can hold; the last one is the robots' states.
/// TappedSample::topic is an index into this list.
const std::vector<RecordedTopic>& recorded_topics();
std::uint32_t states_index();

/// One sample as it was on the wire. `bytes` are valid during the sink's call alone.
struct TappedSample {
  std::uint32_t topic = 0;
  UtcTime received{};
  UtcTime sent{};  ///< by its writer's clock if plausible, else as received
  std::span<const unsigned char> bytes{};
};

/// Receives everything of a run in progress as it is on the bus. On groups agents do not discover
/// it; on topics it reads their cell topics.
class BusTap {
 public:
  using Sink = std::function<void(const TappedSample&)>;
  virtual ~BusTap() = default;

  /// Hands over the samples that arrived; waits up to `timeout` for states.
  virtual void take(Duration timeout, const Sink& sink) = 0;

  /// Whether a reader is matched with a writer of the launcher or planner.
  virtual bool receives_anything() const = 0;
};

/// Joins the run of a directory. `number` distinguishes the monitors of one run.
Result<std::unique_ptr<BusTap>> tap_bus(const std::filesystem::path& run_dir,
                                        std::uint32_t number = 0);

}  // namespace swarm::monitor
