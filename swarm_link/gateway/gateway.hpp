// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "swarm_link/channels/state_channel.hpp"
#include "swarm_link/gate/refusal.hpp"
#include "swarm_link/gate/wire_limits.hpp"
#include "swarm_link/port.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::link {

/// Settings of a gateway. The two cell sizes are those of the mission's channels.
struct GatewayOptions {
  std::uint32_t domain = 0;             ///< DDS domain
  double topic_cell_size_m = 100.0;     ///< cells of the `topics` side
  double group_cell_size_m = 5.0;       ///< cells of the `groups` side
  std::string interface = "127.0.0.1";  ///< address of the interface of the groups
  WireLimits limits;                    ///< ranges of the mission, for the Gate
};

/// Forwards robot states between the two channels. States published by groups become samples of the
/// ordinary cell topics, for monitors and for robots with other DDS implementations; states
/// published on those topics go to the groups and to the other topic readers. Everything passes a
/// Gate, as in an agent, and each state is forwarded once. The gateway receives only groups that a
/// process on its machine has joined, as robots do around themselves. Not thread-safe.
class Gateway {
 public:
  virtual ~Gateway() = default;

  /// Forwards what has arrived and waits up to `timeout` for groups' states. While no other process
  /// has endpoints on the topics it does not receive the groups at all.
  virtual void relay(Duration timeout, UtcTime now) = 0;

  /// Number of robots whose states arrived by topics within this time: with those that publish
  /// there it is matched. O(robots).
  virtual std::uint32_t robots_by_topics(UtcTime now, Duration within) const = 0;
  /// Whether another process has a reader or writer on one of the cell topics.
  virtual bool in_use() const = 0;
  virtual std::uint64_t to_topics() const = 0;  ///< states forwarded
  virtual std::uint64_t to_groups() const = 0;
  /// Refused states. Most are duplicate or stale: echoes of what the gateway published itself.
  virtual const RefusalCounters& refused() const = 0;
};

/// \pre `participant` outlives the gateway and has no other user. Fails when the map has more topic
/// cells than the gateway can have endpoints, or when the interface carries no multicast.
Result<std::unique_ptr<Gateway>> make_gateway(Participant& participant,
                                              const GatewayOptions& options);

}  // namespace swarm::link
