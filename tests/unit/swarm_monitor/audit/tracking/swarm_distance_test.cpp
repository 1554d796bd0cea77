// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/swarm_distance.hpp"

#include <gtest/gtest.h>

#include "tests/unit/swarm_monitor/audit/tracking/planned_run.hpp"

namespace swarm::monitor {
namespace {

SwarmDistance distance_of(std::uint32_t version, double w2_m, double floor_m) {
  return {.plan_version = version, .robots = {.w2_m = w2_m, .floor_m = floor_m}};
}

TEST(SwarmDistance, KeepsTheMomentsItWasGiven) {
  const RecordedRun run = PlannedRun{}.make();
  const auto moments = PlanTimeline(run).moments(2.0, 77.0, 7.5);

  const auto distances = swarm_distances(run, moments);

  ASSERT_EQ(distances.size(), moments.size());
  for (std::size_t k = 0; k < moments.size(); ++k) {
    EXPECT_EQ(distances[k].time_s, moments[k].time_s);
    EXPECT_EQ(distances[k].plan_time_s, moments[k].plan_time_s);
    EXPECT_EQ(distances[k].plan_version, 1U);
    // Every fourth moment and the last one.
    EXPECT_EQ(distances[k].references.has_value(), k % 4 == 0 || k + 1 == moments.size()) << k;
  }
  EXPECT_EQ(distances.front().arrived_share, 0.0);
  EXPECT_EQ(distances.back().arrived_share, 1.0);
}

TEST(SwarmDistance, OfAShiftedSwarmIsTheShift) {
  PlannedRun flight;
  flight.position_m = [&](std::uint32_t robot, double plan_time_s) {
    return Vec2(PlannedRun{}.reference_m(robot, plan_time_s) + Vec2(0.0, 12.0));
  };
  const RecordedRun run = flight.make();

  const auto distances = swarm_distances(run, PlanTimeline(run).moments(10.0, 70.0, 20.0));

  // W2 to a shifted copy of a set is the shift; the sample differs from the plan by its floor.
  for (const SwarmDistance& distance : distances) {
    EXPECT_NEAR(distance.robots.w2_m, 12.0, distance.robots.floor_m) << distance.time_s;
  }
  // The references, which the robots logged unshifted, stay near.
  ASSERT_TRUE(distances.front().references);
  EXPECT_LT(distances.front().references->ratio(), 1.2);
}

TEST(SwarmDistance, LeavesOutReferencesThatTooFewLogged) {
  RecordedRun run = PlannedRun{}.make();
  const auto with_silent = [&](std::size_t silent) {
    RecordedRun changed = run;
    for (std::size_t i = 0; i < silent; ++i) {
      for (TrackPoint& point : changed.tracks[i].points) point.plan_version = 0;
    }
    return mean_reference_distance(
        swarm_distances(changed, PlanTimeline(changed).moments(10.0, 40.0, 10.0)));
  };

  // Nine in ten of 60 are 54.
  EXPECT_TRUE(with_silent(6));
  EXPECT_FALSE(with_silent(7));
}

TEST(SwarmDistance, DependsOnTheRunAlone) {
  const RecordedRun run = PlannedRun{}.make();
  const auto moments = PlanTimeline(run).moments(10.0, 40.0, 10.0);

  const auto first = swarm_distances(run, moments);
  const auto again = swarm_distances(run, moments);

  ASSERT_EQ(first.size(), again.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(first[k].robots.w2_m, again[k].robots.w2_m);
    EXPECT_EQ(first[k].robots.floor_m, again[k].robots.floor_m);
  }
}

TEST(SwarmDistance, OfNoRobotsIsNone) {
  RecordedRun run = PlannedRun{}.make();
  const auto moments = PlanTimeline(run).moments(10.0, 40.0, 10.0);
  run.tracks.clear();
  EXPECT_TRUE(swarm_distances(run, moments).empty());
}

TEST(MeanDistance, IsTheRatioOfMeansAndNotTheMeanOfRatios) {
  const std::vector<SwarmDistance> distances{distance_of(1, 1.0, 1.0), distance_of(1, 8.0, 2.0)};

  const auto mean = mean_distance(distances);

  ASSERT_TRUE(mean);
  EXPECT_DOUBLE_EQ(mean->w2_m, 4.5);
  EXPECT_DOUBLE_EQ(mean->floor_m, 1.5);
  EXPECT_DOUBLE_EQ(mean->ratio(), 3.0);
  EXPECT_FALSE(mean_distance({}));
  EXPECT_EQ(Distance{}.ratio(), 1.0) << "a floor of 0: nothing is measured by it";
}

TEST(MeanReferenceDistance, IsOverTheMomentsThatHaveOne) {
  std::vector<SwarmDistance> distances(3);
  EXPECT_FALSE(mean_reference_distance(distances));
  distances[0].references = Distance{.w2_m = 2.0, .floor_m = 1.0};
  distances[2].references = Distance{.w2_m = 4.0, .floor_m = 2.0};

  const auto mean = mean_reference_distance(distances);

  ASSERT_TRUE(mean);
  EXPECT_DOUBLE_EQ(mean->w2_m, 3.0);
  EXPECT_DOUBLE_EQ(mean->floor_m, 1.5);
}

TEST(DistancesByPlan, GroupTheMomentsOfEachPlan) {
  const std::vector<SwarmDistance> distances{distance_of(1, 1.0, 1.0), distance_of(1, 3.0, 1.0),
                                             distance_of(4, 5.0, 2.0)};

  const auto plans = distances_by_plan(distances);

  ASSERT_EQ(plans.size(), 2U);
  EXPECT_EQ(plans[0].plan_version, 1U);
  EXPECT_EQ(plans[0].moments, 2U);
  EXPECT_DOUBLE_EQ(plans[0].mean.w2_m, 2.0);
  EXPECT_EQ(plans[1].plan_version, 4U);
  EXPECT_EQ(plans[1].moments, 1U);
  EXPECT_DOUBLE_EQ(plans[1].mean.floor_m, 2.0);
  EXPECT_TRUE(distances_by_plan({}).empty());
}

}  // namespace
}  // namespace swarm::monitor
