// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/clearance.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::monitor {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Track make(std::vector<std::pair<double, Vec2>> points, double radius_m = 0.2) {
  Track track{.radius_m = radius_m};
  for (const auto& [time_s, at_m] : points) {
    track.points.push_back({.time_s = time_s, .position_m = at_m});
  }
  return track;
}

Track random_walk(Rng& rng, double size_m, int steps) {
  std::vector<std::pair<double, Vec2>> points;
  double time_s = uniform(rng, 0.0, 3.0);
  Vec2 at(uniform(rng, 0, size_m), uniform(rng, 0, size_m));
  for (int k = 0; k < steps; ++k) {
    points.emplace_back(time_s, at);
    time_s += uniform(rng, 0.02, 0.3);
    at += Vec2(uniform(rng, -0.4, 0.4), uniform(rng, -0.4, 0.4));
  }
  return make(points);
}

std::vector<WorldPhase> always(const World& world) { return {{UtcTime{}, world}}; }

Vec2 position_at(const Track& track, double time_s) {
  for (std::size_t k = 1; k < track.points.size(); ++k) {
    const TrackPoint& a = track.points[k - 1];
    const TrackPoint& b = track.points[k];
    if (time_s > b.time_s) continue;
    return a.position_m +
           (b.position_m - a.position_m) * ((time_s - a.time_s) / (b.time_s - a.time_s));
  }
  return track.points.back().position_m;
}

TEST(Approach, IsFoundBetweenTheTicks) {
  // Two robots pass each other at 1 m, in the middle of one interval.
  const Track a = make({{0.0, {0, 0}}, {1.0, {4, 0}}});
  const Track b = make({{0.0, {4, 1}}, {1.0, {0, 1}}});

  const Approach approach = approach_of(a, b, 0.0, 1.0);

  EXPECT_NEAR(approach.gap_m, 1.0 - 0.4, 1e-12);
  EXPECT_NEAR(approach.time_s, 0.5, 1e-12);
  EXPECT_NEAR(approach.at_m.x(), 2.0, 1e-12);
}

TEST(Approach, CountsOnlyWhileBothAreThere) {
  const Track a = make({{0.0, {0, 0}}, {1.0, {4, 0}}});
  const Track late = make({{2.0, {2, 0}}, {3.0, {2, 0}}});

  EXPECT_EQ(approach_of(a, late, 0.0, 10.0).gap_m, kInfinity);
  EXPECT_EQ(approach_of(a, Track{}, 0.0, 10.0).gap_m, kInfinity);
}

TEST(Approach, IsNeverMissedByFineSampling) {
  Rng rng(2);
  for (int round = 0; round < 60; ++round) {
    const Track a = random_walk(rng, 2.0, 40);
    const Track b = random_walk(rng, 2.0, 40);
    const double from_s = std::max(a.points.front().time_s, b.points.front().time_s);
    const double to_s = std::min(a.points.back().time_s, b.points.back().time_s);
    if (from_s > to_s) continue;
    double sampled = kInfinity;
    for (int k = 0; k <= 20'000; ++k) {
      const double t = from_s + (to_s - from_s) * k / 20'000.0;
      sampled = std::min(sampled, (position_at(a, t) - position_at(b, t)).norm() - 0.4);
    }

    const double exact = approach_of(a, b, -kInfinity, kInfinity).gap_m;

    EXPECT_LE(exact, sampled + 1e-12);
    // Samples every 0.6 ms at a relative speed of at most 57 m/s miss by at most half a step.
    EXPECT_GE(exact, sampled - 0.02);
  }
}

TEST(RobotClearance, EqualsTheComparisonOfAllPairs) {
  Rng rng(5);
  for (int round = 0; round < 20; ++round) {
    std::vector<Track> tracks;
    // From crowded to so sparse that the search has to widen.
    const double size_m = std::array{4.0, 15.0, 60.0, 400.0}[static_cast<std::size_t>(round % 4)];
    for (int i = 0; i < 25; ++i) tracks.push_back(random_walk(rng, size_m, 60));
    double least = kInfinity;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> touching;
    for (std::uint32_t i = 0; i < tracks.size(); ++i) {
      for (std::uint32_t j = i + 1; j < tracks.size(); ++j) {
        const double gap = approach_of(tracks[i], tracks[j], -kInfinity, kInfinity).gap_m;
        least = std::min(least, gap);
        if (gap <= 0.0) touching.emplace_back(i, j);
      }
    }

    const Clearance clearance = robot_clearance(tracks);

    // Interpolated at the borders of windows instead of not at all: rounding.
    EXPECT_NEAR(clearance.nearest.gap_m, least, 1e-9);
    ASSERT_EQ(clearance.contacts.size(), touching.size());
    for (std::size_t k = 0; k < touching.size(); ++k) {
      EXPECT_EQ(clearance.contacts[k].robot, touching[k].first);
      EXPECT_EQ(clearance.contacts[k].other, touching[k].second);
    }
    const double least_of_windows =
        *std::min_element(clearance.by_window_m.begin(), clearance.by_window_m.end());
    EXPECT_NEAR(std::min(least, Clearance::kCap_m), least_of_windows, 1e-9);
  }
}

TEST(RobotClearance, SurvivesRobotsThatJump) {
  std::vector<Track> tracks{make({{0.0, {0, 0}}, {0.1, {1e5, 1e5}}, {0.2, {0, 0}}}),
                            make({{0.0, {5, 5.5}}, {0.2, {5, 5.5}}})};

  const Clearance clearance = robot_clearance(tracks);

  EXPECT_NEAR(clearance.nearest.gap_m, std::sqrt(0.125) - 0.4, 1e-6);
}

TEST(RobotClearance, LetsTheBodyOfAFallenRobotLie) {
  // The first one falls at 2 s at (10, 0); the second one drives over that place at 8 s.
  Track fallen = make({{0.0, {8, 0}}, {2.0, {10, 0}}});
  const Track other = make({{0.0, {0, 0}}, {8.0, {10, 0}}, {12.0, {15, 0}}});
  const std::vector<Track> vanished{fallen, other};
  fallen.body_until_s = 20.0;
  const std::vector<Track> lying{fallen, other};
  fallen.body_until_s = 6.0;  // cleared before the other one comes
  const std::vector<Track> cleared{fallen, other};

  EXPECT_TRUE(robot_clearance(vanished).fallen_contacts.empty());
  EXPECT_TRUE(robot_clearance(cleared).fallen_contacts.empty());
  const Clearance clearance = robot_clearance(lying);
  ASSERT_EQ(clearance.fallen_contacts.size(), 1U);
  EXPECT_NEAR(clearance.fallen_contacts[0].gap_m, -0.4, 1e-9);
  EXPECT_NEAR(clearance.fallen_contacts[0].time_s, 8.0, 1e-9);
  EXPECT_TRUE(clearance.contacts.empty()) << "what both did alive is counted apart";
  EXPECT_NEAR(clearance.nearest.gap_m, robot_clearance(vanished).nearest.gap_m, 1e-12);
}

TEST(RobotClearance, CountsFallenBodiesAsTheComparisonOfAllPairs) {
  Rng rng(6);
  for (int round = 0; round < 10; ++round) {
    std::vector<Track> tracks;
    for (int i = 0; i < 25; ++i) {
      tracks.push_back(random_walk(rng, 12.0, 20 + 10 * (i % 5)));
      if (i % 3 == 0) tracks.back().body_until_s = 30.0;
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> touching;
    for (std::uint32_t i = 0; i < tracks.size(); ++i) {
      for (std::uint32_t j = i + 1; j < tracks.size(); ++j) {
        // From the fall on, the body as a track of its own.
        const auto touches = [&](const Track& body, const Track& robot) {
          const TrackPoint& last = body.points.back();
          if (body.body_until_s <= last.time_s) return false;
          Track lies{.radius_m = body.radius_m};
          for (const double t : {last.time_s, body.body_until_s}) {
            lies.points.push_back({.time_s = t, .position_m = last.position_m});
          }
          Track there = robot;
          if (there.body_until_s > there.points.back().time_s) {
            there.points.push_back(
                {.time_s = there.body_until_s, .position_m = there.points.back().position_m});
          }
          return approach_of(lies, there, -kInfinity, kInfinity).gap_m <= 0.0;
        };
        if (touches(tracks[i], tracks[j]) || touches(tracks[j], tracks[i])) {
          touching.emplace_back(i, j);
        }
      }
    }

    const Clearance clearance = robot_clearance(tracks);

    ASSERT_EQ(clearance.fallen_contacts.size(), touching.size()) << round;
    for (std::size_t k = 0; k < touching.size(); ++k) {
      EXPECT_EQ(clearance.fallen_contacts[k].robot, touching[k].first);
      EXPECT_EQ(clearance.fallen_contacts[k].other, touching[k].second);
    }
  }
}

TEST(RobotClearance, OfOneRobotIsInfinite) {
  const std::vector<Track> tracks{make({{0.0, {0, 0}}, {5.0, {1, 1}}}), Track{}};

  EXPECT_EQ(robot_clearance(tracks).nearest.gap_m, kInfinity);
  EXPECT_EQ(robot_clearance({}).nearest.gap_m, kInfinity);
}

TEST(ObstacleClearance, OfAStraightLinePastACircleIsTheClosedForm) {
  const auto world = World::make({{0, 0}, {20, 20}}, {Circle{{10, 10}, 2.0}});
  ASSERT_TRUE(world.has_value());
  // Nearest in the middle of one long interval, where no step is.
  const std::vector<Track> tracks{make({{0.0, {1, 12.5}}, {7.0, {19, 12.5}}})};

  const Clearance clearance = obstacle_clearance(tracks, always(*world), UtcTime{});

  EXPECT_NEAR(clearance.nearest.gap_m, 0.3, 1e-9);
  EXPECT_NEAR(clearance.nearest.time_s, 3.5, 1e-4);
  EXPECT_TRUE(clearance.contacts.empty());
}

TEST(ObstacleClearance, EqualsFineSamplingInRandomWorlds) {
  Rng rng(9);
  for (int round = 0; round < 30; ++round) {
    std::vector<Obstacle> obstacles{Circle{{uniform(rng, 2, 8), uniform(rng, 2, 8)}, 0.7}};
    const Vec2 c(uniform(rng, 2, 8), uniform(rng, 2, 8));
    auto l_shape = Polygon::make({c, c + Vec2(2, 0), c + Vec2(2, 0.5), c + Vec2(0.5, 0.5),
                                  c + Vec2(0.5, 2), c + Vec2(0, 2)});
    ASSERT_TRUE(l_shape.has_value());
    obstacles.emplace_back(*l_shape);
    const auto world = World::make({{0, 0}, {10, 10}}, obstacles);
    ASSERT_TRUE(world.has_value());
    const std::vector<Track> tracks{random_walk(rng, 10.0, 80), random_walk(rng, 10.0, 80)};
    double sampled = kInfinity;
    for (const Track& track : tracks) {
      for (std::size_t k = 1; k < track.points.size(); ++k) {
        for (int s = 0; s <= 100; ++s) {
          const Vec2 p = track.points[k - 1].position_m +
                         (track.points[k].position_m - track.points[k - 1].position_m) * s / 100.0;
          sampled = std::min(sampled, world->distance_m(p) - 0.2);
        }
      }
    }

    const Clearance clearance = obstacle_clearance(tracks, always(*world), UtcTime{});

    if (sampled > 0.0) {
      EXPECT_LE(clearance.nearest.gap_m, sampled + 1e-9);
      EXPECT_GE(clearance.nearest.gap_m, sampled - 0.003);  // half of 0.57 m / 100
      EXPECT_TRUE(clearance.contacts.empty());
    } else {
      EXPECT_LE(clearance.nearest.gap_m, 0.0);
      EXPECT_FALSE(clearance.contacts.empty());
    }
  }
}

TEST(ObstacleClearance, NamesWhoTouchedWhat) {
  const auto world = World::make({{0, 0}, {20, 20}}, {Circle{{5, 5}, 1.0}, Circle{{15, 15}, 1.0}});
  ASSERT_TRUE(world.has_value());
  const std::vector<Track> tracks{make({{0.0, {2, 2}}, {1.0, {3, 2}}}),
                                  make({{0.0, {15, 10}}, {4.0, {15, 14}}})};

  const Clearance clearance = obstacle_clearance(tracks, always(*world), UtcTime{});

  ASSERT_EQ(clearance.contacts.size(), 1U);
  EXPECT_EQ(clearance.contacts[0].robot, 1U);
  EXPECT_EQ(clearance.contacts[0].other, 1U);
  EXPECT_NEAR(clearance.contacts[0].gap_m, -0.2, 1e-9);
}

// Time 0 of the tracks is second 1000.
UtcTime at_s(double s) { return UtcTime(from_seconds(1000.0 + s)); }

TEST(ObstacleClearance, SeesAnObstacleComeByOnlyWhileItIsThere) {
  const auto empty = World::make({{0, 0}, {40, 20}}, {});
  ASSERT_TRUE(empty.has_value());
  // Added 3 m away at 2 s; from 4 s on it moves past the robot at 1 m/s for 12 s, 0.5 m from it in
  // the middle of a step; gone at 20 s, when the robot drives to where it was.
  std::vector<Scene> scenes{first_scene(0)};
  const auto change = [&](const SceneChange& c, double s) {
    auto next = after(scenes.back(), c, *empty, at_s(s));
    ASSERT_TRUE(next.has_value()) << next.error().message;
    scenes.push_back(*next);
  };
  change(AddObstacle{Circle{{10.0, 8.3}, 1.0}}, 2.0);
  change(MoveObstacle{0, {12.0, 0.0}, 12.0}, 4.0);
  change(RemoveObstacle{0}, 20.0);
  const std::vector<Track> tracks{
      make({{0.0, {13.35, 10.0}}, {20.5, {13.35, 10.0}}, {25.0, {22.0, 8.3}}})};

  const Clearance clearance = obstacle_clearance(tracks, world_phases(*empty, scenes), at_s(0.0));

  EXPECT_NEAR(clearance.nearest.gap_m, 1.7 - 1.0 - 0.2, 1e-9);
  EXPECT_NEAR(clearance.nearest.time_s, 4.0 + 3.35, 1e-4);
  EXPECT_TRUE(clearance.contacts.empty());
}

}  // namespace
}  // namespace swarm::monitor
