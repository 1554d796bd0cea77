// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/beat_sender.hpp"

#include <utility>

#include "swarm_core/mission/supervision_times.hpp"

namespace swarm::launcher {

BeatSender::BeatSender(std::unique_ptr<link::StopSender> sender, std::uint64_t run)
    : sender_(std::move(sender)) {
  beat_.run = run;
}

void BeatSender::step(const FlightTime& now, const Supervisor& supervisor, LateRobots& late,
                      bool lists_all) {
  if (sent_at_ && now.steady - *sent_at_ < from_seconds(1.0 / kBeatHz)) return;
  sent_at_ = now.steady;
  ++beat_.sequence;
  link::set_silent(beat_, supervisor.silent());
  late.list(now.steady, beat_);
  beat_.sent_ns = now.utc.time_since_epoch().count();
  beat_.lists_all = beat_.lists_all && lists_all;
  sender_->send(beat_);
}

}  // namespace swarm::launcher
