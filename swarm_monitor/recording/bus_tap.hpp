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

#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarm_core/robot_log/format.hpp"

namespace swarm::monitor {

/// A topic as recordings have it.
struct RecordedTopic {
  std::string name{};  ///< "swarm/plan"
  mcap::Schema schema{};
};

/// All that a recording of the bus can hold; the last is states. Their order is that of
/// TappedSample::topic.
const std::vector<RecordedTopic>& recorded_topics();
std::uint32_t states_index();

struct TappedSample {
  std::uint32_t topic = 0;
  UtcTime received{};
  UtcTime sent{};  ///< by its writer's clock, where that tells; else as heard
  std::span<const unsigned char> bytes{};
};

/// Hears everything of a run that flies, as it is on the bus, without being heard.
class BusTap {
 public:
  using Sink = std::function<void(const TappedSample&)>;
  virtual ~BusTap() = default;

  /// Hands over what came; waits up to `timeout` for states.
  virtual void take(Duration timeout, const Sink& sink) = 0;

  /// Whether launcher or planner are there.
  virtual bool receives_anything() const = 0;
};

Result<std::unique_ptr<BusTap>> tap_bus(const std::filesystem::path& run_dir,
                                        std::uint32_t number = 0);

}  // namespace swarm::monitor
