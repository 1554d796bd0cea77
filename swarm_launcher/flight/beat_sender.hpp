// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "swarm_launcher/flight/flight_time.hpp"
#include "swarm_launcher/flight/late_robots.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"
#include "swarm_link/channels/stop_channel.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Sends the launcher's beats to all robots: that it runs, which robots it does not receive, and
/// where robots were whose next status is late.
/// Single thread; the time is passed in.
class BeatSender {
 public:
  /// `run`: the begin of the run [ns], by which robots know that a beat is theirs.
  BeatSender(std::unique_ptr<link::StopSender> sender, std::uint64_t run);

  /// Sends a beat if one is due. Call it often. `lists_all`: robots that are not listed may be
  /// taken for healthy ones somewhere else; false while a gateway does not run, since those beyond
  /// it are not received where they are near.
  void step(const FlightTime& now, const Supervisor& supervisor, LateRobots& late,
            bool lists_all = true);

 private:
  std::unique_ptr<link::StopSender> sender_;
  link::LauncherBeat beat_;
  std::optional<SteadyTime> sent_at_;
};

}  // namespace swarm::launcher
