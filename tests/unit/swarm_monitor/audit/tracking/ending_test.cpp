// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/ending.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace swarm::monitor {
namespace {

/// A run that only has a goal: two Gaussians of 1 m, 40 m apart, half of the swarm each.
RecordedRun run_with_goal() {
  RecordedRun run;
  auto goal = Mixture::make({{0.5, Gaussian::from_valid({0, 0}, Mat2::Identity())},
                             {0.5, Gaussian::from_valid({40, 0}, Mat2::Identity())}});
  EXPECT_TRUE(goal.has_value());
  run.mission.goal = *goal;
  return run;
}

/// A robot that ends at a position, and that logged a reference if there is one.
Track ends_at(const Vec2& at_m, std::optional<Vec2> reference_m, bool gracefully = true) {
  TrackPoint last{.time_s = 1.0, .position_m = at_m};
  if (reference_m) {
    last.plan_version = 1;
    last.reference_x_m = static_cast<float>(reference_m->x());
    last.reference_y_m = static_cast<float>(reference_m->y());
  }
  return {.points = {{.time_s = 0.0, .position_m = {-50, 0}}, last},
          .ended_gracefully = gracefully};
}

TEST(Ending, CountsWhoIsNearItsOwnLastReference) {
  RecordedRun run = run_with_goal();
  // Two within 0.7 m, a third within 1 m.
  for (const double off_m : {0.0, 0.6875, 0.75, 5.0}) {
    run.tracks.push_back(ends_at({off_m, 0.0}, Vec2(0.0, 0.0)));
  }

  const Ending ending = ending_of(run);

  EXPECT_DOUBLE_EQ(ending.own_place_share.value(), 0.5);
  EXPECT_DOUBLE_EQ(ending.own_place_wide_share.value(), 0.75);
}

TEST(Ending, DoesNotCountARobotWithoutAReferenceAsBeingThere) {
  RecordedRun run = run_with_goal();
  run.tracks = {ends_at({0, 0}, Vec2(0, 0)), ends_at({1, 0}, std::nullopt)};

  const Ending ending = ending_of(run);

  EXPECT_DOUBLE_EQ(ending.own_place_share.value(), 0.5);
  EXPECT_FALSE(ending.references_to_goal) << "not every robot logged one";
  EXPECT_TRUE(ending.to_goal);
}

TEST(Ending, TakesTheLastReferenceThatARobotLogged) {
  RecordedRun run = run_with_goal();
  Track track = ends_at({3, 0}, Vec2(3, 0));
  // It goes on for a step without a plan: its last reference is still (3, 0).
  track.points.push_back({.time_s = 2.0, .position_m = {3.5, 0.0}});
  run.tracks = {track};

  EXPECT_EQ(ending_of(run).own_place_share, 1.0);
}

TEST(Ending, LeavesOutTheLost) {
  RecordedRun run = run_with_goal();
  run.tracks = {ends_at({0, 0}, Vec2(0, 0)), ends_at({9, 0}, Vec2(0, 0), false),
                Track{.ended_gracefully = true}};

  const Ending ending = ending_of(run);

  EXPECT_EQ(ending.own_place_share, 1.0);
  RecordedRun alone = run_with_goal();
  alone.tracks = {run.tracks[0]};
  EXPECT_EQ(ending.to_goal->w2_m, ending_of(alone).to_goal->w2_m);
}

TEST(Ending, OfARunWithoutEndsIsEmpty) {
  RecordedRun run = run_with_goal();
  run.tracks = {ends_at({0, 0}, Vec2(0, 0), false)};

  for (const Ending& ending : {ending_of(run), ending_of(run_with_goal())}) {
    EXPECT_FALSE(ending.to_goal || ending.references_to_goal || ending.own_place_share ||
                 ending.own_place_wide_share);
  }
}

TEST(Ending, MeasuresTheWholeGoalWhicheverGoalsRobotsName) {
  // All robots end in the left Gaussian, each at its reference: half of them are 40 m from where
  // the goal has them, so that W2 is about 40/√2 m.
  RecordedRun run = run_with_goal();
  for (int i = 0; i < 60; ++i) {
    const Vec2 at(0.2 * (i % 8) - 0.8, 0.2 * (i / 8) - 0.8);
    run.tracks.push_back(ends_at(at, at));
  }

  const Ending ending = ending_of(run);

  EXPECT_EQ(ending.own_place_share, 1.0);
  ASSERT_TRUE(ending.to_goal && ending.references_to_goal);
  EXPECT_NEAR(ending.to_goal->w2_m, 40.0 / std::sqrt(2.0), 1.0);  // spread of a Gaussian: 1 m
  EXPECT_NEAR(ending.references_to_goal->w2_m, ending.to_goal->w2_m, 1.0);
  EXPECT_GT(ending.to_goal->ratio(), 5.0);
}

TEST(Ending, MeasuresTheGoalOfTheNewestScene) {
  RecordedRun run = run_with_goal();
  Scene moved = first_scene(0);
  moved.version = 7;
  moved.goal = *Mixture::make({{1.0, Gaussian::from_valid({500, 0}, Mat2::Identity())}});
  for (int i = 0; i < 20; ++i) run.tracks.push_back(ends_at({0.1 * i, 0.0}, std::nullopt));
  const double before_m = ending_of(run).to_goal->w2_m;

  run.scenes = {first_scene(0), moved};

  EXPECT_LT(before_m, 40.0);
  EXPECT_NEAR(ending_of(run).to_goal->w2_m, 499.0, 2.0);  // mean of the ends is 0.95 m
}

TEST(Ending, OfManyRobotsIsMeasuredOnAFew) {
  RecordedRun run = run_with_goal();
  for (int i = 0; i < 60; ++i) {
    run.tracks.push_back(ends_at({i % 2 == 0 ? 0.0 : 40.0, 0.01 * i}, std::nullopt));
  }

  const auto all = ending_of(run).to_goal;
  const auto few = ending_of(run, 21).to_goal;

  // Of every third robot the floor is that of twenty points: larger.
  ASSERT_TRUE(all && few);
  EXPECT_GT(few->floor_m, all->floor_m);
}

}  // namespace
}  // namespace swarm::monitor
