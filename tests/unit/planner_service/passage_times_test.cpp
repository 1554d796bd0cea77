// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/passage_times.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "planner_service/flow/plan_density.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "tests/unit/planner_service/planners.hpp"

namespace swarm::planner {
namespace {

Gaussian at(double x, double y) { return Gaussian::from_parameters({x, y}, 1.0, 1.0, 0.0); }

Polygon block(double x0, double y0, double x1, double y1) {
  return Polygon::make({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}).value();
}

// Two groups through a door of 6 m; group 1 waits 10 s at its start.
FlowPlan through_a_door() {
  return FlowPlan::make({{at(0, 10), MissionTime(0), 0.75},
                         {at(0, 30), MissionTime(0), 0.25},
                         {at(0, 30), MissionTime(10), 0.25},
                         {at(20, 20), MissionTime(20), 0.75},
                         {at(20, 20), MissionTime(30), 0.25},
                         {at(60, 20), MissionTime(70), 1.0}},
                        {{0, 3, 0.75}, {1, 2, 0.25}, {2, 4, 0.25}, {3, 5, 0.75}, {4, 5, 0.25}})
      .value();
}

TEST(PassageTimes, FindTheNarrowestPassage) {
  // The door, a narrower gap that no mean passes, and a wider one behind.
  const World world =
      World::make({{-50, -50}, {100, 100}},
                  {block(30, -40, 32, 17), block(30, 23, 32, 60), block(30, 61, 32, 90),
                   block(50, -40, 51, 10), Circle{{50, 35}, 5.0}})
          .value();

  const auto passage = narrowest_passage(through_a_door(), world);

  ASSERT_TRUE(passage.has_value());
  EXPECT_NEAR(passage->width_m(), 6.0, 1e-9);
  EXPECT_NEAR(std::min(passage->from_m.y(), passage->to_m.y()), 17.0, 1e-9);
  EXPECT_FALSE(
      narrowest_passage(through_a_door(), World::make({{-50, -50}, {100, 100}}, {}).value())
          .has_value());
}

TEST(PassageTimes, AreThoseOfEachGroup) {
  const Passage door{{30, 17}, {30, 23}};

  const auto groups = group_times(through_a_door(), door, 1.25);

  ASSERT_EQ(groups.size(), 2U);
  EXPECT_DOUBLE_EQ(groups[0].share, 0.75);
  EXPECT_DOUBLE_EQ(groups[0].leaves.first.count(), 0.0);
  EXPECT_DOUBLE_EQ(groups[1].leaves.first.count(), 10.0);
  // A quarter of the legs from x = 20 m to 60 m.
  ASSERT_TRUE(groups[0].passes && groups[1].passes);
  EXPECT_DOUBLE_EQ(groups[0].passes->half.count(), 20.0 + 50.0 / 4.0);
  EXPECT_DOUBLE_EQ(groups[1].passes->half.count(), 30.0 + 40.0 / 4.0);
  EXPECT_DOUBLE_EQ(groups[1].arrives.last.count(), 70.0);
  const double path_m = std::hypot(20.0, 10.0) + 40.0;
  EXPECT_NEAR(groups[0].waits_on_average.count(), 70.0 - path_m / 1.25, 1e-9);
  EXPECT_NEAR(groups[1].waits_on_average.count(), 70.0 - path_m / 1.25, 1e-9);
}

TEST(PassageTimes, AreATableWithALineForEachGroup) {
  const Passage door{{30, 17}, {30, 23}};
  const FlowPlan plan = through_a_door();

  EXPECT_EQ(to_table(group_times(plan, door, 1.25), door, 40.0),
            "narrowest passage: 6.0 m between (30.0, 17.0) and (30.0, 23.0) m\n"
            "times in s: first, half, last\n"
            "group robots |        leaves        |        passes        |       arrives        | "
            "waits\n"
            "    0     30 |    0.0    0.0    0.0 |   32.5   32.5   32.5 |   70.0   70.0   70.0 |  "
            "20.1\n"
            "    1     10 |   10.0   10.0   10.0 |   40.0   40.0   40.0 |   70.0   70.0   70.0 |  "
            "20.1\n");
}

TEST(PassageTimes, OfAGroupThatPassesNothingAreNotGiven) {
  // Group 1 stays on its side.
  const auto plan = FlowPlan::make({{at(0, 10), MissionTime(0), 0.5},
                                    {at(0, 30), MissionTime(0), 0.5},
                                    {at(60, 20), MissionTime(50), 0.5},
                                    {at(10, 30), MissionTime(20), 0.5}},
                                   {{0, 2, 0.5}, {1, 3, 0.5}})
                        .value();

  const auto groups = group_times(plan, Passage{{30, 10}, {30, 23}}, 1.25);
  const auto without = group_times(plan, std::nullopt, 1.25);

  ASSERT_EQ(groups.size(), 2U);
  ASSERT_TRUE(groups[0].passes.has_value());
  EXPECT_DOUBLE_EQ(groups[0].passes->half.count(), 25.0);
  EXPECT_FALSE(groups[1].passes.has_value());
  EXPECT_FALSE(without[0].passes.has_value());
  EXPECT_TRUE(
      to_table(without, std::nullopt, 10.0).starts_with("no passage between two obstacles"));
}

double speed_mps(const Mission& mission) {
  return test::planner_of(mission).method().traits().speed_mps;
}

// When half of the second group passes without a density cap.
MissionTime free_half(Mission mission, std::uint64_t seed) {
  mission.planner.density_cap_per_m2 = 0.0;
  Rng rng(seed);
  const FlowPlan flow = test::plan_mission(mission, rng).value().plan;
  return group_times(flow, narrowest_passage(flow, mission.world), speed_mps(mission))
      .at(1)
      .passes.value()
      .half;
}

TEST(PassageTimes, ShowThatTheSecondGroupWaitsAtTheDoor) {
  const auto mission =
      load_mission(std::filesystem::path(SWARM_SOURCE_DIR) / "deploy/missions/doorway.yaml");
  ASSERT_TRUE(mission.has_value()) << mission.error().message;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Rng rng(seed);
    const auto result = test::plan_mission(*mission, rng);
    ASSERT_TRUE(result.has_value()) << result.error().message;

    const auto passage = narrowest_passage(result->plan, mission->world);
    const auto groups = group_times(result->plan, passage, speed_mps(*mission));

    ASSERT_TRUE(passage.has_value());
    EXPECT_NEAR(passage->width_m(), 8.0, 1e-9);
    ASSERT_TRUE(groups[0].passes && groups[1].passes);
    // The group that is nearer passes first; the other waits until it is through, some seconds
    // beyond when it passes without a cap.
    EXPECT_GT(groups[1].passes->first, groups[0].passes->last);
    EXPECT_GT(groups[1].passes->half, free_half(*mission, seed) + MissionTime(4.0));
    EXPECT_LE(max_density(result->plan, 100.0, 0.5).per_m2, 2.0 + 1e-9);
  }
}

}  // namespace
}  // namespace swarm::planner
