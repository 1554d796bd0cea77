// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarm_link/gate/refusal.hpp"
#include "swarm_link/gate/wire_limits.hpp"
#include "swarm_link/port.hpp"
#include "swarm_link/channels/state_channel.hpp"

namespace swarm::link {

struct GatewayOptions {
  std::uint32_t domain = 0;
  double topic_cell_size_m = 100.0;
  double group_cell_size_m = 5.0;
  std::string interface = "127.0.0.1";
  WireLimits limits;
};

/// Carries robot states between the two channels: what is published by groups becomes samples of the
/// ordinary cell topics, for monitors and robots of other makes, and what those say goes to the
/// groups and to each other. Everything is checked as an agent would; a state goes on once. Of the
/// groups it hears those that somebody on its machine has joined, as robots do around them.
class Gateway {
 public:
  virtual ~Gateway() = default;

  /// Carries what there is; waits up to `timeout` for something to come. As long as nobody
  /// listens to the topics or speaks there, it does not even hear the groups.
  virtual void relay(Duration timeout, UtcTime now) = 0;

  /// Whether somebody listens or speaks.
  virtual bool in_use() const = 0;
  virtual std::uint64_t to_topics() const = 0;  ///< states carried
  virtual std::uint64_t to_groups() const = 0;
  /// Most are duplicate or stale: echoes of what it published itself.
  virtual const RefusalCounters& refused() const = 0;
};

/// \pre `participant` outlives the gateway, and nobody else uses it. Fails when the map has more
/// topic cells than endpoints are good for, or the interface carries no multicast.
Result<std::unique_ptr<Gateway>> make_gateway(Participant& participant,
                                              const GatewayOptions& options);

}  // namespace swarm::link
