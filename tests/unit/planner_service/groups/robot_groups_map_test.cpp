// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Groups on drawn maps, beside a second implementation of their rule.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "planner_service/groups/robot_groups.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

// A map of squares of 2 m, the first line at the top: '#' is an obstacle.
World drawn(const std::vector<std::string>& rows) {
  constexpr double kCell_m = 2.0;
  std::vector<Obstacle> obstacles;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double y = kCell_m * static_cast<double>(rows.size() - 1 - r);
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      if (rows[r][c] != '#') continue;
      const double x = kCell_m * static_cast<double>(c);
      obstacles.push_back(
          Polygon::make({{x, y}, {x + kCell_m, y}, {x + kCell_m, y + kCell_m}, {x, y + kCell_m}})
              .value());
    }
  }
  const Vec2 corner_m(kCell_m * static_cast<double>(rows[0].size()),
                      kCell_m * static_cast<double>(rows.size()));
  return World::make({{0, 0}, corner_m}, std::move(obstacles)).value();
}

const std::vector<std::string> kRooms{
    "....................", "......##............", "......##.....####...", "......##............",
    "......##............", "..######....##......", "............##......", "............##......",
    "............##......", "............##......"};

Mixture far_goal() {
  return Mixture::make({{1.0, Gaussian::from_parameters({38, 18}, 0.5, 0.5, 0)}}).value();
}

// Robots with ids in order, not nearer to an obstacle than any Gaussian may be.
std::vector<ReportedRobot> random_swarm(const World& world, std::uint32_t robots, Rng& rng) {
  std::vector<ReportedRobot> swarm;
  while (swarm.size() < robots) {
    const Vec2 at_m(uniform(rng, 0, 40), uniform(rng, 0, 20));
    if (!world.is_clear(at_m, 0.6)) continue;
    swarm.push_back(
        {.robot = RobotId(static_cast<std::uint32_t>(swarm.size())), .position_m = at_m});
  }
  return swarm;
}

// The rule: robot after robot joins the nearest of the first robots of groups that it can see
// within the radius, or becomes one.
std::vector<std::vector<std::uint32_t>> by_rule(const World& world,
                                                const std::vector<ReportedRobot>& swarm,
                                                double radius_m) {
  std::vector<std::vector<std::uint32_t>> groups;
  for (std::uint32_t i = 0; i < swarm.size(); ++i) {
    std::vector<std::pair<double, std::size_t>> seen;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const Vec2& first_m = swarm[groups[g][0]].position_m;
      const double distance_m = (first_m - swarm[i].position_m).norm();
      if (distance_m <= radius_m && world.segment_is_free(first_m, swarm[i].position_m, 0.0)) {
        seen.emplace_back(distance_m, g);
      }
    }
    if (seen.empty()) {
      groups.push_back({i});
    } else {
      groups[std::min_element(seen.begin(), seen.end())->second].push_back(i);
    }
  }
  return groups;
}

std::vector<std::vector<std::uint32_t>> ids(const std::vector<RobotGroup>& groups) {
  std::vector<std::vector<std::uint32_t>> all;
  for (const RobotGroup& group : groups) {
    all.emplace_back();
    for (const RobotId id : group.members) all.back().push_back(id.value());
    std::sort(all.back().begin(), all.back().end());
  }
  return all;
}

TEST(RobotGroupsOnMaps, FollowTheirRule) {
  const World world = drawn(kRooms);
  const Mixture goal = far_goal();
  Rng rng(1);
  for (int i = 0; i < 20; ++i) {
    const auto swarm = random_swarm(world, 60, rng);
    const double radius_m = uniform(rng, 2.0, 9.0);

    const auto groups = group_robots({world, goal, swarm}, {}, {.radius_m = radius_m});

    ASSERT_TRUE(groups.has_value()) << groups.error().message;
    EXPECT_EQ(ids(*groups), by_rule(world, swarm, radius_m)) << i;
  }
}

TEST(RobotGroupsOnMaps, GrowByHalvesUntilTheyAreFewEnough) {
  const World world = drawn(kRooms);
  const Mixture goal = far_goal();
  Rng rng(2);
  for (const std::size_t most : {4U, 8U, 20U}) {
    const auto swarm = random_swarm(world, 80, rng);
    double radius_m = 1.0;
    while (by_rule(world, swarm, radius_m).size() > most && radius_m < 1000.0) radius_m *= 1.5;

    const auto groups =
        group_robots({world, goal, swarm}, {}, {.radius_m = 1.0, .groups_max = most});

    ASSERT_TRUE(groups.has_value()) << groups.error().message;
    EXPECT_EQ(ids(*groups), by_rule(world, swarm, radius_m));
  }
}

TEST(RobotGroupsOnMaps, StaySeparateBehindWallsAtAnyRadius) {
  // Three rooms without a door: one group is allowed, three there are.
  const World world = drawn({"...#...#...", "...#...#...", "...#...#..."});
  const Mixture goal = Mixture::make({{1.0, Gaussian::from_parameters({20, 3}, 1, 1, 0)}}).value();
  const std::vector<ReportedRobot> swarm{{.robot = RobotId(0), .position_m = {3, 3}},
                                         {.robot = RobotId(1), .position_m = {11, 3}},
                                         {.robot = RobotId(2), .position_m = {19, 3}}};

  const auto groups = group_robots({world, goal, swarm}, {}, {.groups_max = 1});

  ASSERT_TRUE(groups.has_value()) << groups.error().message;
  EXPECT_EQ(groups->size(), 3U);
}

TEST(MixtureOfGroups, WeighsEachByItsRobots) {
  const auto at = [](double x) { return Gaussian::from_parameters({x, 0}, 1, 1, 0); };
  const std::vector<RobotGroup> groups{{at(1), {RobotId(4)}},
                                       {at(2), {RobotId(0), RobotId(9), RobotId(2)}}};

  const Mixture mixture = mixture_of(groups);

  ASSERT_EQ(mixture.components().size(), 2U);
  EXPECT_EQ(mixture.components()[0].weight, 0.25);
  EXPECT_EQ(mixture.components()[1].weight, 0.75);
  EXPECT_EQ(mixture.components()[1].gaussian.mean_m(), Vec2(2, 0));
}

TEST(ComponentAt, FindsTheGoalWithThisMeanAlone) {
  const auto at = [](double x) { return Gaussian::from_parameters({x, 0}, 1, 1, 0); };
  const Mixture goal = Mixture::make({{0.5, at(1)}, {0.5, at(2)}}).value();

  EXPECT_EQ(component_at(goal, {2, 0}), 1U);
  EXPECT_EQ(component_at(goal, {1.0 + 1e-9, 0}), 0U) << "rounding makes no other goal";
  EXPECT_EQ(component_at(goal, {1.5, 0}), std::nullopt);
}

}  // namespace
}  // namespace swarm::planner
