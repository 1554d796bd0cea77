// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "swarm_monitor/view/foxglove_session.hpp"
#include "swarm_monitor/view/view_source.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::monitor {

/// The channels that Foxglove clients see of a source: three with Foxglove's own schemas, then the
/// raw ones as they are. The newest sample of every channel is kept for later subscribers, since a
/// plan may come once in a run.
class FoxgloveFeed {
 public:
  explicit FoxgloveFeed(ViewSource& source);
  ~FoxgloveFeed();
  FoxgloveFeed(const FoxgloveFeed&) = delete;
  FoxgloveFeed& operator=(const FoxgloveFeed&) = delete;

  const std::vector<FoxgloveChannel>& channels() const { return channels_; }
  /// The newest sample of a channel; no bytes if there was none yet.
  FoxgloveSample newest(std::uint32_t channel) const;

  /// Called after the source's poll(): hands new samples to the sessions.
  void step(UtcTime now, std::span<FoxgloveSession* const> sessions);

 private:
  // Keeps a raw sample and marks its channel as fresh.
  void take_raw(const RawSample& sample);
  void take_channels();
  void take_obstacles(UtcTime now);
  void take_view_frame(UtcTime now, bool robots, bool mixture);
  void set(std::uint32_t channel, UtcTime stamp, std::vector<std::byte> bytes);

  ViewSource& source_;
  std::vector<FoxgloveChannel> channels_;
  std::vector<FoxgloveSample> newest_;
  std::vector<bool> fresh_;    // channels with a sample that was not offered yet
  std::size_t raw_known_ = 0;  // raw channels of the source that have a channel here
  std::size_t scenes_seen_ = 0;
  std::optional<UtcTime> raw_time_;  // of the newest raw sample
  UtcTime next_view_frame_{};        // due time
  std::vector<std::byte> view_frame_;
};

}  // namespace swarm::monitor
