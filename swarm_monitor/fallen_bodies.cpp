// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/fallen_bodies.hpp"

#include <algorithm>

namespace swarm::monitor {

void lay_fallen_bodies(RecordedRun& run) {
  double end_s = 0.0;
  for (const Track& track : run.tracks) {
    if (!track.points.empty()) end_s = std::max(end_s, track.points.back().time_s);
  }
  for (Track& track : run.tracks) {
    if (!track.ended_gracefully && !track.points.empty()) track.body_until_s = end_s;
  }
}

}  // namespace swarm::monitor
