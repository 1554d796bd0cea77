// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/scene_change_file.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

World mission_world() { return World::make({{-100, -100}, {100, 100}}, {}).value(); }

/// A coordinate with all its bits; every fourth is a whole number.
double coordinate(Rng& rng) {
  const double x = uniform(rng, -99, 99);
  return rng() % 4 == 0 ? std::round(x) : x;
}
Vec2 point(Rng& rng) {
  const double x = coordinate(rng);
  return {x, coordinate(rng)};
}
Circle circle(Rng& rng) {
  const Vec2 center_m = point(rng);
  return {center_m, uniform(rng, 1e-3, 9)};
}
Polygon triangle(Rng& rng) {
  for (;;) {
    const Vec2 a = point(rng), b = point(rng), c = point(rng);
    if (auto made = Polygon::make({a, b, c})) return *made;
  }
}
Mixture mixture(Rng& rng) {
  std::vector<WeightedGaussian> components;
  const std::uint64_t count = rng() % 4 + 1;
  for (std::uint64_t i = 0; i < count; ++i) {
    const Vec2 mean_m = point(rng);
    const double a = uniform(rng, 0.1, 9), b = uniform(rng, 0.1, 9);
    components.push_back({1.0 / static_cast<double>(count),
                          Gaussian::from_parameters(mean_m, a, b, uniform(rng, -0.9, 0.9))});
  }
  return Mixture::make(components).value();
}

/// A random change of each kind.
std::vector<SceneChange> changes(Rng& rng) {
  const auto number = [&](std::uint64_t below) {
    return static_cast<std::uint32_t>(rng() % below);
  };
  return {AddObstacle{circle(rng)},
          AddObstacle{triangle(rng)},
          MoveObstacle{number(1'000'001), point(rng), uniform(rng, 0, 1e6)},
          RemoveObstacle{number(1'000'001)},
          GoTo{mixture(rng)},
          SetRisk{uniform(rng, 1e-6, 0.99)},
          AddBody{RobotId(number(200'000)), circle(rng)},
          ClearBody{RobotId(number(200'000))}};
}

void expect_same(const Mixture& a, const Mixture& b) {
  ASSERT_EQ(a.components().size(), b.components().size());
  for (std::size_t i = 0; i < a.components().size(); ++i) {
    EXPECT_EQ(a.components()[i].gaussian.mean_m(), b.components()[i].gaussian.mean_m());
    EXPECT_EQ(a.components()[i].gaussian.covariance_m2(),
              b.components()[i].gaussian.covariance_m2());
    // Weights are normalised again: one rounding.
    EXPECT_NEAR(a.components()[i].weight, b.components()[i].weight, 1e-15);
  }
}

// Audits replay a run from these texts, so they must hold every number to its last bit.
TEST(SceneChangeKeys, ReadBackBitForBit) {
  const World world = mission_world();
  Rng rng(5);
  for (int round = 0; round < 200; ++round) {
    for (const SceneChange& change : changes(rng)) {
      const std::string keys = keys_of(change);

      const auto read = parse_scene_change(std::string(name_of(change)), keys, world);

      ASSERT_TRUE(read.has_value()) << keys << ": " << read.error().message;
      ASSERT_EQ(read->index(), change.index()) << keys;
      EXPECT_EQ(keys.find('\n'), std::string::npos);
      if (const auto* go = std::get_if<GoTo>(&change)) {
        expect_same(go->goal, std::get<GoTo>(*read).goal);
      } else {
        // Doubles are written so that they read back: equal texts are equal numbers.
        EXPECT_EQ(keys_of(*read), keys);
      }
    }
  }
}

TEST(SceneChangeKeys, MayStandInBraces) {
  Rng rng(6);
  for (const SceneChange& change : changes(rng)) {
    const std::string name(name_of(change));
    for (const char* form : {"{{{}}}", "  {{{}}}", " {} "}) {
      const std::string keys = fmt::format(fmt::runtime(form), keys_of(change));

      const auto read = parse_scene_change(name, keys, mission_world());

      ASSERT_TRUE(read.has_value()) << keys << ": " << read.error().message;
      EXPECT_EQ(read->index(), change.index());
    }
  }
}

TEST(SceneChangeKeys, AreRefusedAtTheMistake) {
  struct Case {
    std::string action, keys, message;
  };
  // Without braces the reader adds one, so columns count from 2.
  const Case cases[] = {
      {"risk", "{alpha: 0}", "risk:1:9: alpha is 0; must be >= 1e-06 and <= 0.999999"},
      {"risk", "", "risk:1:1: alpha is missing; add it"},
      {"risk", "{alpha: 0.1, alpha: 0.2}",
       "risk:1:14: alpha is given twice; remove it here or in line 1"},
      {"risk", "{alfa: 0.1, alpha: 0.1}", "risk:1:2: unknown key alfa; did you mean alpha?"},
      {"move_obstacle", "{obstacle: 0, by_m: [1e7, 0]}",
       "move_obstacle:1:22: by_m[0] is 10000000; must be >= -1000000 and <= 1000000"},
      {"move_obstacle", "{obstacle: 1.5, by_m: [1, 0], over_s: -1}",
       "move_obstacle:1:12: obstacle is 1.5; must be a whole number\n"
       "move_obstacle:1:39: over_s is -1; must be >= 0 and <= 1000000"},
      {"add_obstacle", "{}",
       "add_obstacle:1:1: add_obstacle has no shape; must have one of polygon_m and circle_m"},
      {"add_obstacle", "{circle_m: {center: [0, 0], radius: 1}, polygon_m: []}",
       "add_obstacle:1:1: add_obstacle has two shapes; must have one of polygon_m and circle_m"},
      {"add_obstacle", "{polygon_m: [[0, 0], [1, 0]]}",
       "add_obstacle:1:13: add_obstacle.polygon_m has 2 items; must have between 3 and 10000"},
      {"add_obstacle", "{circle_m: {center: [0, x], radius: 0}}",
       "add_obstacle:1:25: add_obstacle.circle_m.center[1] is \"x\", no number; must be >= "
       "-1000000 "
       "and <= 1000000\n"
       "add_obstacle:1:37: add_obstacle.circle_m.radius is 0; must be > 0 and <= 1000000"},
      {"goto", "{goal: [{mean_m: [101, 0], covariance_m2: [[1, 0], [0, 1]], weight: 1}]}",
       "goto:1:18: goal[0].mean_m is (101, 0), outside the world; must lie within world.bounds_m"},
      {"goto", "{goal: []}", "goto:1:8: goal has 0 items; must have between 1 and 255"},
      {"clear", "{robot: 200000}", "clear:1:9: robot is 200000; must be >= 0 and <= 199999"},
      {"clear", "7 8", "clear:1:9: robot is \"7 8\", no number; must be >= 0 and <= 199999"},
      {"fly", "{}", "fly: unknown"},
  };
  for (const auto& [action, keys, message] : cases) {
    const auto read = parse_scene_change(action, keys, mission_world());

    ASSERT_FALSE(read.has_value()) << action << ' ' << keys;
    EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
    EXPECT_EQ(read.error().message, message);
  }
}

// An operator's goal may lie where a later change frees the area; the planner checks it then.
TEST(SceneChangeKeys, MayNameAGoalInsideAnObstacle) {
  const World world = World::make({{-100, -100}, {100, 100}}, {Circle{{0, 0}, 10}}).value();

  EXPECT_TRUE(
      parse_scene_change(
          "goto", "goal: [{mean_m: [0, 0], covariance_m2: [[1, 0], [0, 1]], weight: 1}]", world)
          .has_value());
}

// Keys come from people and from files: any text gives a change or a message.
TEST(SceneChangeKeys, SurviveAnyDamage) {
  constexpr std::string_view kBytes = "{}[]:,-+.e0123456789x \n\"'\\\x01\xFF";
  Rng rng(8);
  for (int round = 0; round < 300; ++round) {
    for (const SceneChange& change : changes(rng)) {
      std::string keys = keys_of(change);
      for (std::uint64_t i = rng() % 3 + 1; i > 0; --i) {
        keys[rng() % keys.size()] = kBytes[rng() % kBytes.size()];
      }

      const auto read = parse_scene_change(std::string(name_of(change)), keys, mission_world());

      if (!read) {
        EXPECT_FALSE(read.error().message.empty()) << keys;
      }
    }
  }
}

}  // namespace
}  // namespace swarm
