// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::monitor {

/// A topic of the bus or of a recording, whose samples are passed on unchanged.
struct RawChannel {
  std::string topic{};   ///< "swarm/plan"
  std::string type{};    ///< "swarm::wire::FlowPlan"
  std::string schema{};  ///< self-contained OMG IDL
};

/// One sample: plain CDR with its encapsulation.
struct RawSample {
  std::uint32_t channel = 0;  ///< index into raw_channels()
  UtcTime stamp{};
  std::span<const std::byte> bytes{};
};

/// What a viewer can see of a swarm, in progress or recorded. Texts and frames are those of
/// PROTOCOL.md. Used by one thread.
class ViewSource {
 public:
  virtual ~ViewSource() = default;

  /// Takes in what is new. Returns at once.
  virtual void poll(UtcTime now) = 0;

  virtual bool live() const = 0;

  /// All `scene` messages so far; grows when something changes.
  virtual const std::vector<std::string>& scenes() const = 0;
  /// Events so far, one JSON object each.
  virtual const std::vector<std::string>& events() const = 0;
  /// Rows of the series so far, one JSON array each.
  virtual const std::vector<std::string>& series() const = 0;

  /// Replaces `out` by a frame: of a time since the begin [s], or the newest.
  virtual void view_frame(std::optional<double> time_s, std::optional<RobotId> focus,
                          std::vector<std::byte>& out) = 0;

  /// Point to which the positions in frames are relative (view_frame.hpp).
  virtual Vec2 origin_m() const { return Vec2::Zero(); }

  /// The topics that are passed on to Foxglove unchanged. The list only grows.
  virtual const std::vector<RawChannel>& raw_channels() const = 0;
  /// Sets the receiver of every sample that poll() takes in; nullptr: none.
  virtual void on_raw(std::function<void(const RawSample&)> sink) = 0;

  /// Prometheus text.
  virtual std::string metrics() const = 0;
};

}  // namespace swarm::monitor
