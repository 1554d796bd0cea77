// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/groups/robot_groups.hpp"

#include <gtest/gtest.h>

#include "planner_service/groups/group_shape.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarmflow/core/cvar.hpp"
#include "tests/unit/planner_service/robots_in_flight.hpp"

namespace swarm::planner {
namespace {

const test::StandinScene& scene() {
  static const test::StandinScene s = test::standin_scene();
  return s;
}

TEST(RobotGroups, HoldEveryRobotOnceAndKeepTheRiskLimit) {
  const auto robots = test::robots_in_flight(200);
  const RiskLimit risk;
  const auto groups = group_robots({scene().world, scene().goal, robots}, risk, {});
  ASSERT_TRUE(groups.has_value()) << groups.error().message;

  std::vector<int> seen(200, 0);
  for (const RobotGroup& group : *groups) {
    EXPECT_TRUE(in_free(group.gaussian, scene().world, cvar_coefficient(risk.alpha), risk.delta_m));
    for (const RobotId id : group.members) {
      ++seen[id.value()];
      EXPECT_LT((robots[id.value()].position_m - group.gaussian.mean_m()).norm(), 12.0);
    }
  }
  EXPECT_EQ(seen, std::vector<int>(200, 1));
  EXPECT_LE(groups->size(), 64U);
}

TEST(RobotGroups, DoNotReachThroughWalls) {
  // Two rows of robots on both sides of a thin wall.
  const World world =
      World::make({{0, 0}, {40, 20}},
                  {Polygon::make({{19.9, 2}, {20.1, 2}, {20.1, 18}, {19.9, 18}}).value()})
          .value();
  std::vector<ReportedRobot> robots;
  for (std::uint32_t i = 0; i < 10; ++i) {
    robots.push_back({RobotId(i), {i % 2 == 0 ? 18.0 : 22.0, 10.0 + 0.1 * i}, false});
  }
  const Mixture goal = Mixture::make({{1.0, Gaussian::from_parameters({35, 10}, 1, 1, 0)}}).value();

  const auto groups = group_robots({world, goal, robots}, {}, {});

  ASSERT_TRUE(groups.has_value());
  ASSERT_EQ(groups->size(), 2U);
  for (const RobotGroup& group : *groups) {
    for (const RobotId id : group.members) EXPECT_EQ(id.value() % 2, group.members[0].value() % 2);
  }
}

TEST(RobotGroups, LetArrivedRobotsStay) {
  const Gaussian& at_goal = scene().goal.components()[1].gaussian;
  const std::vector<ReportedRobot> robots{{RobotId(0), at_goal.mean_m(), true},
                                          {RobotId(1), at_goal.mean_m() + Vec2(3, 2), true},
                                          {RobotId(2), at_goal.mean_m() + Vec2(1, 1), false}};

  const auto groups = group_robots({scene().world, scene().goal, robots}, {}, {});

  ASSERT_TRUE(groups.has_value());
  ASSERT_EQ(groups->size(), 2U);
  EXPECT_EQ(groups->at(0).members.size(), 2U);
  EXPECT_EQ(wasserstein2(groups->at(0).gaussian, at_goal), 0.0);
}

TEST(RobotGroups, ReportWhereThereIsNoRoom) {
  // A slot of 0.5 m: half of it is less than k σ + 0.2 m for any σ ≥ 0.1 m.
  const World world =
      World::make({{0, 0}, {10, 10}},
                  {Polygon::make({{0, 0}, {10, 0}, {10, 4.75}, {0, 4.75}}).value(),
                   Polygon::make({{0, 5.25}, {10, 5.25}, {10, 10}, {0, 10}}).value()})
          .value();
  const std::vector<ReportedRobot> robots{{RobotId(0), {5, 5}, false}};
  const Mixture goal = Mixture::make({{1.0, Gaussian::from_parameters({9, 5}, 1, 1, 0)}}).value();

  const auto groups = group_robots({world, goal, robots}, {}, {});

  ASSERT_FALSE(groups.has_value());
  EXPECT_EQ(groups.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(groups.error().message.find("(5.0, 5.0)"), std::string::npos);
}

TEST(GroupShape, HasTheMomentsOfItsMembersAndTheFloor) {
  const std::vector<ReportedRobot> robots{{.robot = RobotId(7), .position_m = {1, 1}},
                                          {.robot = RobotId(3), .position_m = {-3, 1}},
                                          {.robot = RobotId(5), .position_m = {2, 4}}};
  Members members;
  for (const ReportedRobot& robot : robots) members.push_back(&robot);

  const Gaussian shape = shape_of(members, 0.5);

  EXPECT_LT((shape.mean_m() - Vec2(0, 2)).norm(), 1e-12);
  // Offsets (1, -1), (-3, -1), (2, 2): mean squares 14/3 and 2, mean product 2.
  EXPECT_NEAR(shape.covariance_m2()(0, 0), 14.0 / 3.0 + 0.25, 1e-12);
  EXPECT_NEAR(shape.covariance_m2()(1, 1), 2.0 + 0.25, 1e-12);
  EXPECT_NEAR(shape.covariance_m2()(0, 1), 2.0, 1e-12);

  sort_along_axis(members, shape);
  EXPECT_EQ(ids_of(members), (std::vector<RobotId>{RobotId(3), RobotId(7), RobotId(5)}));
}

}  // namespace
}  // namespace swarm::planner
