// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/health_inbox.hpp"

#include <cstddef>
#include <utility>

namespace swarm::launcher {

HealthInbox::HealthInbox(Readers readers, const link::WireLimits& limits)
    : readers_(std::move(readers)),
      gate_({.limits = limits, .own_source = link::kLauncherSource}) {}

void HealthInbox::receive(UtcTime now) {
  statuses_.clear();
  readers_.status->take(statuses_);
  std::erase_if(statuses_,
                [&](const link::StatusMessage& status) { return !gate_.status(status, now); });
  receive_events();
  heartbeats_.clear();
  readers_.heartbeat->take(heartbeats_);
  std::erase_if(heartbeats_,
                [&](const link::HeartbeatMessage& beat) { return !gate_.heartbeat(beat, now); });
  gate_.set_undecodable(readers_.status->undecodable() + readers_.event->undecodable() +
                        readers_.heartbeat->undecodable());
}

// Events under the launcher's own source are refused as forged; see GateOptions::own_source.
void HealthInbox::receive_events() {
  events_.clear();
  event_senders_.clear();
  readers_.event->take_with_senders(events_, event_senders_);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    if (!gate_.event(events_[i])) continue;
    if (kept != i) events_[kept] = std::move(events_[i]);
    event_senders_[kept++] = event_senders_[i];
  }
  events_.resize(kept);
  event_senders_.resize(kept);
}

}  // namespace swarm::launcher
