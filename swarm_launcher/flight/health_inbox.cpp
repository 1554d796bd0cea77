// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/health_inbox.hpp"

#include <cstddef>
#include <utility>

#include "swarm_core/app/file_watch.hpp"

namespace swarm::launcher {
namespace {

/// Takes what arrived on a topic and keeps what the check accepts.
template <class M, class Check>
void take_checked(link::Reader<M>& reader, std::vector<M>& out, std::vector<std::uint64_t>& senders,
                  Check check) {
  out.clear();
  senders.clear();
  reader.take_with_senders(out, senders);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!check(out[i], senders[i])) continue;
    if (kept != i) out[kept] = std::move(out[i]);
    senders[kept++] = senders[i];
  }
  out.resize(kept);
  senders.resize(kept);
}

}  // namespace

HealthInbox::HealthInbox(Readers readers, const link::WireLimits& limits)
    : readers_(std::move(readers)),
      gate_({.limits = limits, .own_source = link::kLauncherSource}) {}

// Events last: whose they may be follows from statuses and heartbeats.
void HealthInbox::receive(UtcTime now) {
  take_checked(*readers_.status, statuses_, senders_,
               [&](const link::StatusMessage& status, std::uint64_t sender) {
                 return gate_.status_of(status, {sender, now}).has_value();
               });
  take_checked(*readers_.heartbeat, heartbeats_, senders_,
               [&](const link::HeartbeatMessage& beat, std::uint64_t sender) {
                 return gate_.heartbeat_of(beat, {sender, now}).has_value();
               });
  // Lost records fail the audit of the run.
  take_checked(*readers_.event, events_, event_senders_,
               [&](const link::EventMessage& event, std::uint64_t sender) {
                 const bool is_evidence = event.code == shell::kRecordsLost;
                 return gate_.event_of(event, {sender, now}, is_evidence).has_value();
               });
  gate_.set_undecodable(readers_.status->undecodable() + readers_.event->undecodable() +
                        readers_.heartbeat->undecodable());
}

}  // namespace swarm::launcher
