// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/swarm_walk.hpp"

#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::monitor {
namespace {

/// Looks at every step: where a robot is, or nothing if it does not live at that time.
std::optional<Vec2> by_all_steps(const Track& track, double time_s) {
  for (std::size_t k = 0; k < track.points.size(); ++k) {
    const TrackPoint& a = track.points[k];
    if (a.time_s == time_s) return a.position_m;
    if (k + 1 == track.points.size()) break;
    const TrackPoint& b = track.points[k + 1];
    if (a.time_s < time_s && time_s < b.time_s) {
      const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
      return Vec2((1.0 - share) * a.position_m + share * b.position_m);
    }
  }
  const bool ended = !track.points.empty() && time_s > track.points.back().time_s;
  if (ended && track.ended_gracefully) return track.points.back().position_m;
  return std::nullopt;
}

Track random_track(Rng& rng, std::uint32_t robot) {
  Track track{.robot = RobotId(robot)};
  track.ended_gracefully = rng() % 2 == 0;
  double time_s = uniform(rng, 0.0, 10.0);
  const std::size_t steps = rng() % 12;
  for (std::size_t k = 0; k < steps; ++k) {
    track.points.push_back(
        {.time_s = time_s, .position_m = {uniform(rng, -9, 9), uniform(rng, -9, 9)}});
    time_s += uniform(rng, 0.1, 3.0);
  }
  return track;
}

TEST(SwarmWalk, EqualsTheSearchThroughAllSteps) {
  Rng rng(21);
  for (int round = 0; round < 60; ++round) {
    std::vector<Track> tracks;
    for (std::uint32_t i = 0; i < 12; ++i) tracks.push_back(random_track(rng, i));
    SwarmWalk walk(tracks);
    // Moments ascend, some repeat, some are the time of a step itself.
    std::vector<double> times_s;
    for (int k = 0; k < 40; ++k) times_s.push_back(uniform(rng, -1.0, 45.0));
    for (const Track& track : tracks) {
      if (!track.points.empty()) times_s.push_back(track.points.back().time_s);
    }
    times_s.push_back(times_s.front());
    std::sort(times_s.begin(), times_s.end());

    for (const double time_s : times_s) {
      const std::vector<RobotNow>& living = walk.at(time_s);
      auto next = living.begin();
      for (std::uint32_t i = 0; i < tracks.size(); ++i) {
        const auto expected = by_all_steps(tracks[i], time_s);
        const bool is_alive = next != living.end() && next->robot == i;
        ASSERT_EQ(is_alive, expected.has_value()) << "robot " << i << " at " << time_s;
        if (!is_alive) continue;
        EXPECT_NEAR((next->position_m - *expected).norm(), 0.0, 1e-12);  // rounding
        ++next;
      }
      EXPECT_EQ(next, living.end());
    }
  }
}

TEST(SwarmWalk, GivesTheLastStepByThen) {
  Track track{.points = {{.time_s = 1.0, .mode = RobotMode::kWaiting},
                         {.time_s = 2.0, .mode = RobotMode::kMoving},
                         {.time_s = 3.0, .mode = RobotMode::kArrived}},
              .ended_gracefully = true};
  SwarmWalk walk(std::span(&track, 1));

  for (const auto& [time_s, step] : {std::pair{1.0, 0}, {1.9, 0}, {2.0, 1}, {2.5, 1}, {9.0, 2}}) {
    const auto& living = walk.at(time_s);
    ASSERT_EQ(living.size(), 1U) << time_s;
    EXPECT_EQ(living[0].step, &track.points[static_cast<std::size_t>(step)]) << time_s;
  }
}

TEST(SwarmWalk, LeavesALostRobotOutAfterItsLastStep) {
  Track track{.points = {{.time_s = 1.0}, {.time_s = 2.0}}};
  SwarmWalk walk(std::span(&track, 1));

  EXPECT_TRUE(walk.at(0.999).empty());
  EXPECT_EQ(walk.at(2.0).size(), 1U) << "at its last step it is still alive";
  EXPECT_TRUE(walk.at(2.001).empty());
}

TEST(SwarmWalk, OfNoRobotsIsEmpty) {
  SwarmWalk walk({});
  EXPECT_TRUE(walk.at(0.0).empty());
}

TEST(MotionOf, LastsFromTheFirstStepInMotionToTheLastStepOfAll) {
  std::vector<Track> tracks(3);
  // Robot 0 waits for ever and is the last to end; robot 2 has no log.
  tracks[0].points = {{.time_s = 0.0}, {.time_s = 40.0}};
  tracks[1].points = {{.time_s = 1.0},
                      {.time_s = 5.0, .mode = RobotMode::kMoving},
                      {.time_s = 6.0, .mode = RobotMode::kArrived},
                      {.time_s = 7.0, .mode = RobotMode::kMoving}};

  const auto motion = motion_of(tracks);

  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->begin_s, 5.0);
  EXPECT_EQ(motion->end_s, 40.0);
}

TEST(MotionOf, IsEmptyIfNoRobotMoves) {
  std::vector<Track> tracks(1);
  EXPECT_FALSE(motion_of(tracks));
  for (const RobotMode mode :
       {RobotMode::kWaiting, RobotMode::kHolding, RobotMode::kArrived, RobotMode::kStopped}) {
    tracks[0].points.push_back(
        {.time_s = static_cast<double>(tracks[0].points.size()), .mode = mode});
  }
  EXPECT_FALSE(motion_of(tracks));
}

TEST(ArrivedShare, CountsTheLivingByTheirLastStep) {
  std::vector<Track> tracks(4);
  for (Track& track : tracks) track.points = {{.time_s = 0.0, .mode = RobotMode::kMoving}};
  for (Track& track : tracks) track.ended_gracefully = true;
  tracks[1].points.push_back({.time_s = 2.0, .mode = RobotMode::kArrived});
  tracks[3].ended_gracefully = false;  // lost after its only step
  SwarmWalk walk(tracks);

  EXPECT_EQ(arrived_share(walk.at(1.0)), 0.0);
  EXPECT_DOUBLE_EQ(arrived_share(walk.at(2.0)), 1.0 / 3.0);
  EXPECT_EQ(arrived_share({}), 0.0);
}

}  // namespace
}  // namespace swarm::monitor
