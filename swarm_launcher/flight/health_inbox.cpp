// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/health_inbox.hpp"

#include <utility>

namespace swarm::launcher {

HealthInbox::HealthInbox(link::ReaderPtr<link::StatusMessage> statuses,
                         link::ReaderPtr<link::EventMessage> events, const link::WireLimits& limits)
    : status_reader_(std::move(statuses)),
      event_reader_(std::move(events)),
      gate_({.limits = limits, .own_source = link::kLauncherSource}) {}

// Events under the launcher's own source are refused as forged; see GateOptions::own_source.
void HealthInbox::receive(UtcTime now) {
  statuses_.clear();
  status_reader_->take(statuses_);
  std::erase_if(statuses_,
                [&](const link::StatusMessage& status) { return !gate_.status(status, now); });
  events_.clear();
  event_reader_->take(events_);
  std::erase_if(events_, [&](const link::EventMessage& event) { return !gate_.event(event); });
  gate_.set_undecodable(status_reader_->undecodable() + event_reader_->undecodable());
}

}  // namespace swarm::launcher
