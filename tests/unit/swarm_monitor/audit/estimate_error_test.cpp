// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/estimate_error.hpp"

#include <gtest/gtest.h>

namespace swarm::monitor {
namespace {

/// Drives along x at 1 m/s from time 1 s to 11 s.
Track driver(std::uint32_t robot) {
  Track track{.robot = RobotId(robot)};
  for (int k = 0; k <= 10; ++k) {
    track.points.push_back({.time_s = 1.0 + k, .position_m = {1.0 * k, 0.0}});
  }
  return track;
}

TEST(EstimateError, IsThatToTheTrackBetweenItsPoints) {
  std::vector<Track> tracks{driver(0), driver(1)};
  // At 3.5 s robot 1 is at x = 2.5.
  tracks[0].estimates = {{.time_s = 3.5, .neighbour = RobotId(1), .position_m = {2.5, 0.04}}};

  const auto error = estimate_error(tracks);

  ASSERT_TRUE(error);
  EXPECT_NEAR(error->p50_cm, 4.0, 1e-9);
  EXPECT_NEAR(error->max_cm, 4.0, 1e-9);
}

TEST(EstimateError, RanksAllOfThem) {
  std::vector<Track> tracks{driver(0), driver(1)};
  for (int k = 1; k <= 100; ++k) {
    tracks[0].estimates.push_back(
        {.time_s = 2.0, .neighbour = RobotId(1), .position_m = {1.0, 0.01 * k}});
  }

  const auto error = estimate_error(tracks);

  ASSERT_TRUE(error);
  EXPECT_NEAR(error->p50_cm, 50.0, 1e-9);
  EXPECT_NEAR(error->p99_cm, 99.0, 1e-9);
  EXPECT_NEAR(error->p999_cm, 100.0, 1e-9);
}

TEST(EstimateError, LeavesOutWhatNoTrackCanAnswer) {
  std::vector<Track> tracks{driver(0), driver(1)};
  tracks[0].estimates = {{.time_s = 0.5, .neighbour = RobotId(1), .position_m = {9, 9}},
                         {.time_s = 11.5, .neighbour = RobotId(1), .position_m = {9, 9}},
                         {.time_s = 5.0, .neighbour = RobotId(7), .position_m = {9, 9}}};

  EXPECT_FALSE(estimate_error(tracks));
}

}  // namespace
}  // namespace swarm::monitor
