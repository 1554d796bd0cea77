// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarm_link/gate/gate.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::link {

/// Filters what a gateway receives from both channels, so that each state is forwarded once. The
/// gateway also receives what it publishes itself and refuses it as duplicate or stale: echoes. Not
/// thread-safe.
class GatewayInbox {
 public:
  explicit GatewayInbox(const WireLimits& limits) : gate_({.limits = limits}) {}

  /// Appends to `fresh` the states of the batches that are newer than all before.
  void take_fresh(std::span<const CellStatesMessage> batches, UtcTime now,
                  std::vector<RobotStateMessage>& fresh);

  /// `so_far`: batches that could not be decoded, of all readers together, since the start.
  void set_undecodable(std::uint64_t so_far) { gate_.set_undecodable(so_far); }

  const RefusalCounters& refused() const { return gate_.refused(); }

 private:
  Gate gate_;  ///< keeps the newest stamp of each robot
};

}  // namespace swarm::link
