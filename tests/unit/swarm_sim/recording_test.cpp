// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/recording.hpp"

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

/// The positions, in metres, that a recording keeps of a robot that is at k m in period k.
std::vector<double> kept_m(std::uint64_t every, std::uint32_t periods) {
  Mission mission;
  mission.robots.count = 1;
  Recording recording(mission, UtcTime{}, every);
  for (std::uint32_t k = 0; k < periods; ++k) {
    recording.begin_period();
    recording.step(RobotId(0), {.stamp = UtcTime{} + k * std::chrono::milliseconds(1),
                                .position_m = {static_cast<double>(k), 0.0}});
  }
  const std::vector<monitor::Track> tracks = recording.tracks();
  std::vector<double> places_m;
  for (const monitor::TrackPoint& p : tracks[0].points) {
    places_m.push_back(p.position_m.x());
  }
  return places_m;
}

using Places = std::vector<double>;

TEST(Recording, KeepsEveryPeriod) { EXPECT_EQ(kept_m(1, 4), (Places{0, 1, 2, 3})); }

TEST(Recording, KeepsEveryNthPeriodAndTheLast) {
  EXPECT_EQ(kept_m(5, 12), (Places{0, 5, 10, 11}));
  EXPECT_EQ(kept_m(5, 11), (Places{0, 5, 10}));
  EXPECT_EQ(kept_m(Recording::kFirstAndLast, 7), (Places{0, 6}));
}

TEST(Recording, OfOnePeriodOrNone) {
  EXPECT_EQ(kept_m(5, 1), (Places{0}));
  EXPECT_EQ(kept_m(5, 0), Places{});
}

}  // namespace
}  // namespace swarm::launcher
