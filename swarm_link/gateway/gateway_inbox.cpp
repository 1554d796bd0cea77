// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gateway/gateway_inbox.hpp"

namespace swarm::link {

// A refused batch is dropped as a whole; a refused state does not affect the rest of its batch.
void GatewayInbox::take_fresh(std::span<const CellStatesMessage> batches, UtcTime now,
                              std::vector<RobotStateMessage>& fresh) {
  for (const CellStatesMessage& batch : batches) {
    if (!gate_.batch(batch)) continue;
    for (const RobotStateMessage& state : batch.states) {
      if (gate_.newer_state(state, now)) fresh.push_back(state);
    }
  }
}

}  // namespace swarm::link
