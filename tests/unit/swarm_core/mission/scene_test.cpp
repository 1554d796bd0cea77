// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/mission/scene.hpp"

#include <gtest/gtest.h>

#include "swarm_core/mission/scene_bodies.hpp"
#include "swarm_core/mission_file/scene_change_file.hpp"
#include "swarm_core/mission_file/scene_log.hpp"

namespace swarm {
namespace {

UtcTime at_s(double s) { return UtcTime(from_seconds(s)); }

/// A circle (obstacle 0) and a square (obstacle 1).
World mission_world() {
  return World::make(
             {{0, 0}, {40, 20}},
             {Circle{{5, 5}, 1.0}, Polygon::make({{9, 9}, {11, 9}, {11, 11}, {9, 11}}).value()})
      .value();
}

Scene changed(const Scene& scene, const SceneChange& change, double s) {
  auto next = after(scene, change, mission_world(), at_s(s));
  EXPECT_TRUE(next.has_value()) << next.error().message;
  return next.value_or(scene);
}

TEST(Scene, BeginsAsInTheMissionFile) {
  const World world = world_at(mission_world(), first_scene(2), at_s(5));

  ASSERT_EQ(world.obstacles().size(), 2U);
  EXPECT_EQ(world.distance_m({5, 5}), -1.0);
  EXPECT_EQ(world.bounds_m().max_m, Vec2(40, 20));
}

TEST(Scene, NumbersAddedObstaclesInOrderAndNeverTwice) {
  Scene scene = changed(first_scene(2), AddObstacle{Circle{{20, 10}, 1.0}}, 1.0);
  scene = changed(scene, RemoveObstacle{2}, 2.0);
  scene = changed(scene, AddObstacle{Circle{{30, 10}, 1.0}}, 3.0);

  EXPECT_FALSE(after(scene, RemoveObstacle{2}, mission_world(), at_s(4)).has_value());
  ASSERT_EQ(scene.obstacles.size(), 1U);
  const SceneObstacle& added = scene.obstacles[0];
  EXPECT_EQ(added.id, 3U);
  EXPECT_FALSE(added.owner.has_value());
  const World world = world_at(mission_world(), scene, at_s(4));
  EXPECT_EQ(world.obstacles().size(), 3U);
  EXPECT_EQ(world.distance_m({30, 10}), -1.0);
  EXPECT_GT(world.distance_m({20, 10}), 5.0);
}

TEST(Scene, MovesAnObstacleEvenlyAndOnlyForItsTime) {
  // 6 m in 3 s from second 10 on.
  const Scene scene = changed(first_scene(2), MoveObstacle{0, {6, 0}, 3.0}, 10.0);
  for (const auto& [s, x] :
       {std::pair{9.0, 5.0}, {10.0, 5.0}, {11.0, 7.0}, {13.0, 11.0}, {50.0, 11.0}}) {
    EXPECT_NEAR(world_at(mission_world(), scene, at_s(s)).distance_m({x, 5}), -1.0, 1e-9) << s;
  }
  const auto velocity = [&](double s) {
    return world_at(mission_world(), scene, at_s(s)).convex_obstacles()[0].velocity_mps;
  };
  EXPECT_EQ(velocity(11.0), Vec2(2, 0));
  EXPECT_EQ(velocity(13.0), Vec2(0, 0));
  EXPECT_TRUE(scene.moves(at_s(12.9)));
  EXPECT_FALSE(scene.moves(at_s(13.0)));
}

TEST(Scene, BeginsAMoveWhereTheLastOneIs) {
  Scene scene = changed(first_scene(2), MoveObstacle{1, {8, 0}, 8.0}, 0.0);
  scene = changed(scene, MoveObstacle{1, {0, 2}, 0.0}, 4.0);  // at once, and it stops

  EXPECT_NEAR(world_at(mission_world(), scene, at_s(30)).distance_m({14, 12}), -1.0, 1e-9);
}

TEST(Scene, RefusesMovesThatReceiversWouldRefuse) {
  const Scene scene = first_scene(2);
  const auto is_accepted = [&](const MoveObstacle& move) {
    return after(scene, move, mission_world(), at_s(1)).has_value();
  };
  EXPECT_TRUE(is_accepted({0, {999'990, 0}, 0.0}));
  EXPECT_FALSE(is_accepted({0, {1'000'000, 0}, 0.0}));
  EXPECT_FALSE(is_accepted({1, {0, -1'000'020}, 10.0}));
  EXPECT_TRUE(is_accepted({0, {10, 0}, 1e-4}));
  EXPECT_FALSE(is_accepted({0, {10, 0}, 1e-6}));
}

// Shorter than the clock's tick: at once.
TEST(Scene, MovesAnObstacleAtOnceInNoTime) {
  const Scene scene = changed(first_scene(2), MoveObstacle{0, {6, 0}, 1e-10}, 10.0);
  EXPECT_NEAR(world_at(mission_world(), scene, at_s(10)).distance_m({11, 5}), -1.0, 1e-9);
}

TEST(Scene, KeepsAMapForAWhileWithAllPositionsOfAMove) {
  const Scene scene = changed(first_scene(2), MoveObstacle{0, {4, 0}, 2.0}, 0.0);

  const World world = world_during(mission_world(), scene, at_s(0), std::chrono::seconds(2));

  for (const double x : {5.0, 7.0, 9.0}) EXPECT_NEAR(world.distance_m({x, 5}), -1.0, 1e-9);
}

TEST(Scene, FallsIntoPhasesOfEvenMotion) {
  std::vector<Scene> scenes{first_scene(2)};
  scenes.push_back(changed(scenes.back(), MoveObstacle{0, {4, 0}, 2.0}, 10.0));
  scenes.push_back(changed(scenes.back(), RemoveObstacle{1}, 20.0));

  const auto phases = world_phases(mission_world(), scenes);

  ASSERT_EQ(phases.size(), 4U);  // file, moving, moved, removed
  EXPECT_EQ(phases[1].begin, at_s(10));
  EXPECT_EQ(phases[2].begin, at_s(12));
  EXPECT_EQ(phases[3].begin, at_s(20));
  EXPECT_EQ(phases[1].world.convex_obstacles()[0].velocity_mps, Vec2(2, 0));
  EXPECT_EQ(phases[2].world.convex_obstacles()[0].velocity_mps, Vec2(0, 0));
  EXPECT_EQ(phases[3].world.obstacles().size(), 1U);
  EXPECT_TRUE(lasting_world(mission_world(), scenes).obstacles().empty());
}

TEST(Scene, RefusesMoreThanItsMessageHolds) {
  Scene scene = first_scene(2);
  for (std::size_t i = 0; i < Scene::kMaxObstacles; ++i) {
    scene = changed(scene, AddObstacle{Circle{{20, 10}, 0.1}}, static_cast<double>(i));
  }
  EXPECT_FALSE(
      after(scene, AddObstacle{Circle{{20, 10}, 0.1}}, mission_world(), at_s(999)).has_value());
}

TEST(SceneLog, ReplaysWhatWasWritten) {
  const std::vector<SceneChange> changes{
      AddObstacle{Circle{{20, 10}, 1.25}},
      AddObstacle{Polygon::make({{30, 1}, {33, 1}, {31, 4}}).value()},
      MoveObstacle{2, {0.1, -1.0 / 3.0}, 7.5},
      RemoveObstacle{0},
      GoTo{Mixture::make({{1.0, Gaussian::from_parameters({3, 3}, 1, 2, 0.5)}}).value()},
      SetRisk{0.15},
      AddBody{RobotId(7), Circle{{12.1, 1.0 / 3.0}, 0.325}},
      AddBody{RobotId(3), Circle{{30.5, 8}, 0.2}},
      ClearBody{RobotId(7)}};
  std::string text;
  Scene scene = first_scene(2);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    scene = changed(scene, changes[i], 1e9 + static_cast<double>(i));
    text += scene_log_line(scene.version, changes[i]);
  }

  const auto scenes = replay_scene_log(text, mission_world());

  ASSERT_EQ(scenes.size(), changes.size() + 1);
  const Scene& last = scenes.back();
  EXPECT_EQ(last.version, scene.version);
  EXPECT_EQ(last.removed, scene.removed);
  EXPECT_EQ(last.risk_alpha, 0.15);
  ASSERT_TRUE(last.goal.has_value());
  EXPECT_EQ(last.goal->components()[0].gaussian.covariance_m2(),
            scene.goal->components()[0].gaussian.covariance_m2());
  ASSERT_EQ(last.obstacles.size(), 3U);
  EXPECT_EQ(last.obstacles[2].owner, RobotId(3));
  EXPECT_EQ(std::get<Circle>(scenes[scenes.size() - 2].obstacles[3].shape).center_m.y(), 1.0 / 3.0);
  EXPECT_EQ(last.obstacles[0].velocity_mps, scene.obstacles[0].velocity_mps);
  EXPECT_EQ(last.obstacles[0].moving_until, scene.obstacles[0].moving_until);
  EXPECT_EQ(std::get<Polygon>(last.obstacles[1].shape).vertices_m(),
            std::get<Polygon>(scene.obstacles[1].shape).vertices_m());
}

Circle body_at(double x) { return {{x, 10}, 0.3}; }

TEST(SceneBodies, AreObstaclesUntilTheyAreCleared) {
  Scene scene = changed(first_scene(2), AddBody{RobotId(9), body_at(20)}, 1.0);
  scene = changed(scene, AddBody{RobotId(4), body_at(25)}, 2.0);
  EXPECT_TRUE(has_body(scene, RobotId(4)));
  const World world = world_at(mission_world(), scene, at_s(3));
  EXPECT_NEAR(world.distance_m({20, 10}), -0.3, 1e-12);
  EXPECT_EQ(world.bodies().size(), 2U);
  EXPECT_EQ(world.without_bodies().obstacles().size(), 2U);
  EXPECT_GT(world.without_bodies().distance_m({20, 10}), 4.0);

  const Scene cleared = changed(scene, ClearBody{RobotId(9)}, 4.0);

  EXPECT_FALSE(has_body(cleared, RobotId(9)));
  EXPECT_GT(world_at(mission_world(), cleared, at_s(5)).distance_m({20, 10}), 4.0);
  const auto again = after(cleared, ClearBody{RobotId(9)}, mission_world(), at_s(6));
  ASSERT_FALSE(again.has_value());
  EXPECT_NE(again.error().message.find("robot 9"), std::string::npos);
}

TEST(SceneBodies, AreOneARobot) {
  Scene scene = changed(first_scene(2), AddBody{RobotId(9), body_at(20)}, 1.0);
  scene = changed(scene, AddBody{RobotId(9), body_at(22)}, 2.0);

  ASSERT_EQ(scene.obstacles.size(), 1U);
  EXPECT_EQ(std::get<Circle>(scene.obstacles[0].shape).center_m.x(), 22.0);
}

TEST(SceneBodies, TakeNoNumberOfAnotherObstacle) {
  Scene scene = changed(first_scene(2), AddBody{RobotId(0), body_at(20)}, 1.0);
  scene = changed(scene, AddObstacle{Circle{{30, 10}, 1.0}}, 2.0);
  scene = changed(scene, MoveObstacle{2, {1, 0}, 0.0}, 3.0);

  EXPECT_NEAR(world_at(mission_world(), scene, at_s(4)).distance_m({31, 10}), -1.0, 1e-12);
  EXPECT_NEAR(world_at(mission_world(), scene, at_s(4)).distance_m({20, 10}), -0.3, 1e-12);
}

TEST(SceneBodies, CanBeLeftOut) {
  Scene scene = changed(first_scene(2), AddObstacle{Circle{{30, 10}, 1.0}}, 1.0);
  for (std::uint32_t i = 3; i < 7; ++i) scene = changed(scene, AddBody{RobotId(i), body_at(20)}, i);

  EXPECT_EQ(without_bodies(scene).obstacles.size(), 1U);
  const Scene own_left_out = without_bodies_of(scene, RobotId(4), 2);
  ASSERT_EQ(own_left_out.obstacles.size(), 3U);
  EXPECT_EQ(own_left_out.obstacles[1].owner, RobotId(3));
  EXPECT_EQ(own_left_out.obstacles[2].owner, RobotId(6));
}

TEST(SceneBodies, AreNoObstaclesOfTheAudit) {
  std::vector<Scene> scenes = {first_scene(2)};
  scenes.push_back(changed(scenes.back(), AddBody{RobotId(1), body_at(20)}, 1.0));

  EXPECT_GT(world_phases(mission_world(), scenes).back().world.distance_m({20, 10}), 4.0);
  EXPECT_EQ(lasting_world(mission_world(), scenes).obstacles().size(), 2U);
}

TEST(SceneBodies, AreReportedWithTheirTimes) {
  std::vector<Scene> scenes = {first_scene(2)};
  const auto add = [&](const SceneChange& change, double s) {
    scenes.push_back(changed(scenes.back(), change, s));
  };
  add(AddBody{RobotId(1), body_at(20)}, 1.0);
  add(AddBody{RobotId(2), body_at(25)}, 2.0);
  add(ClearBody{RobotId(1)}, 3.0);
  add(AddBody{RobotId(1), body_at(30)}, 4.0);

  const std::vector<FallenBody> bodies = bodies_of(scenes);

  ASSERT_EQ(bodies.size(), 3U);
  EXPECT_EQ(bodies[0].robot, RobotId(1));
  EXPECT_EQ(bodies[0].from, at_s(1.0));
  EXPECT_EQ(bodies[0].cleared, at_s(3.0));
  EXPECT_EQ(bodies[1].robot, RobotId(2));
  EXPECT_FALSE(bodies[1].cleared.has_value());
  EXPECT_EQ(bodies[2].shape.center_m.x(), 30.0);
  EXPECT_FALSE(bodies[2].cleared.has_value());
}

TEST(SceneBodies, AreAtMostAsManyAsTheSceneHolds) {
  Scene scene = first_scene(2);
  for (std::uint32_t i = 0; i < Scene::kMaxObstacles; ++i) {
    scene = changed(scene, AddBody{RobotId(i), body_at(20)}, 1.0);
  }

  const auto one_more =
      after(scene, AddBody{RobotId(999), body_at(20)}, mission_world(), at_s(2.0));

  ASSERT_FALSE(one_more.has_value());
  EXPECT_NE(one_more.error().message.find("256"), std::string::npos);
}

// A full disk took a part of a line, and later the whole one.
TEST(SceneLog, LeavesOutALineThatIsCut) {
  const std::string first = scene_log_line(5, SetRisk{0.3}),
                    second = scene_log_line(6, SetRisk{0.4});
  for (std::size_t size = 1; size + 1 < second.size(); ++size) {
    const auto scenes =
        replay_scene_log(first + second.substr(0, size) + "\n" + second, mission_world());
    ASSERT_EQ(scenes.size(), 3U) << size;
    EXPECT_EQ(scenes.back().version, 6U);
  }
}

TEST(SceneLog, EndsWhereALineIsDamaged) {
  const std::string good = scene_log_line(5, SetRisk{0.3});
  for (const char* bad : {"[1, 2]\n", "{\"utc_ns\": -3, \"action\": \"risk\", \"keys\": \"\"}\n",
                          "{\"utc_ns\": 6, \"action\": \"jump\", \"keys\": \"\"}\n",
                          "{\"utc_ns\": 6, \"action\": \"risk\", \"keys\": 7}\n"}) {
    EXPECT_EQ(replay_scene_log(good + bad + good, mission_world()).size(), 2U) << bad;
  }
}

TEST(SceneChange, IsReadFromACommandLine) {
  const auto change =
      parse_scene_change("add_obstacle", "circle_m: {center: [6, 4], radius: 3}", mission_world());

  ASSERT_TRUE(change.has_value()) << change.error().message;
  EXPECT_EQ(std::get<Circle>(std::get<AddObstacle>(*change).shape).radius_m, 3.0);
  EXPECT_TRUE(parse_scene_change("risk", "{alpha: 0.2}", mission_world()).has_value());
  for (const char* keys : {" 7", "7", "robot: 7"}) {
    const auto clear = parse_scene_change("clear", keys, mission_world());
    ASSERT_TRUE(clear.has_value()) << keys << ": " << clear.error().message;
    EXPECT_EQ(std::get<ClearBody>(*clear).robot, RobotId(7));
  }
}

TEST(SceneChange, ReportsWhatIsWrongWithACommandLine) {
  const auto wrong = [](const char* action, const char* keys) {
    const auto change = parse_scene_change(action, keys, mission_world());
    return change ? std::string("nothing") : change.error().message;
  };
  EXPECT_NE(wrong("risk", "alpha: 2").find("alpha is 2; must be"), std::string::npos);
  EXPECT_NE(wrong("risk", "").find("alpha is missing"), std::string::npos);
  EXPECT_NE(wrong("move_obstacle", "obstacle: 0, by_m: [1]").find("list of 2"), std::string::npos);
  EXPECT_NE(wrong("remove_obstacle", "obstacle: 0, speed: 1").find("unknown key"),
            std::string::npos);
  EXPECT_NE(wrong("clear", "").find("robot is missing"), std::string::npos);
  EXPECT_NE(wrong("clear", "all").find("clear:1:"), std::string::npos);
  EXPECT_NE(wrong("clear", "robot: -1").find("robot is -1"), std::string::npos);
  EXPECT_NE(wrong("add_body", "robot: 1, polygon_m: [[1, 1], [2, 1], [2, 2]]").find("circle_m"),
            std::string::npos);
  EXPECT_NE(wrong("explode", "obstacle: 0").find("explode"), std::string::npos);
  EXPECT_NE(wrong("add_obstacle", "circle_m: {").find("add_obstacle:1:"), std::string::npos);
}

}  // namespace
}  // namespace swarm
