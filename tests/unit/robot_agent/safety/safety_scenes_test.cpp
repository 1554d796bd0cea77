// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
//
// Random scenes for the safety filter alone, with the worst method above it: straight to the goal
// at full speed. SWARM_SCENES sets how many (100000 takes some minutes).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/safety/safety_filter.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

constexpr double kRadius_m = 0.2;
constexpr double kSpeed_mps = 1.5;
constexpr double kPeriod_s = 0.1;

int scenes() {
  const char* const wanted = std::getenv("SWARM_SCENES");
  return wanted != nullptr ? std::atoi(wanted) : 1000;
}

SafetyOptions options() {
  return {
      .radius_m = kRadius_m, .speed_max_mps = kSpeed_mps, .period = std::chrono::milliseconds(100)};
}

enum class Kind { kObeys, kFrozen, kRams };

struct Body {
  Vec2 position;
  Vec2 goal;
  Kind kind = Kind::kObeys;
  Vec2 velocity = Vec2::Zero();
};

/// Each robot knows all others as of the last tick.
void step(std::vector<Body>& bodies, std::vector<SafetyFilter>& filters) {
  std::vector<Vec2> commanded(bodies.size(), Vec2::Zero());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec2 path = bodies[i].goal - bodies[i].position;
    const double far_m = path.norm();
    const Vec2 desired_velocity =
        far_m > 1e-9 ? Vec2(path * (std::min(kSpeed_mps, 2.0 * far_m) / far_m)) : Vec2::Zero();
    if (bodies[i].kind == Kind::kFrozen) continue;
    if (bodies[i].kind == Kind::kRams) {
      commanded[i] = desired_velocity;
      continue;
    }
    std::vector<Neighbour> neighbours;
    for (std::size_t j = 0; j < bodies.size(); ++j) {
      if (i == j) continue;
      neighbours.push_back({.robot = RobotId(static_cast<std::uint32_t>(j)),
                            .position_m = bodies[j].position,
                            .velocity_mps = bodies[j].velocity,
                            .radius_m = kRadius_m,
                            .information_age_s = kPeriod_s});
    }
    commanded[i] = filters[i].filter(bodies[i].position, desired_velocity, neighbours, far_m > 2.0);
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].velocity = commanded[i];
    bodies[i].position += kPeriod_s * commanded[i];
  }
}

bool room_for(const Vec2& p, const std::vector<Body>& bodies, const World& world) {
  if (world.distance_m(p) < kRadius_m + 0.4) return false;
  return std::all_of(bodies.begin(), bodies.end(),
                     [&](const Body& b) { return (b.position - p).norm() > 2 * kRadius_m + 0.4; });
}

Vec2 random_place(Rng& rng, double half_m) {
  return {uniform(rng, -half_m, half_m), uniform(rng, -half_m, half_m)};
}

/// Least gap between robots that use the filter, and from them to obstacles, over ten seconds.
double fly(std::vector<Body> bodies, const World& world) {
  std::vector<SafetyFilter> filters(bodies.size(), SafetyFilter(world, options()));
  double least_m = 1e9;
  for (int k = 0; k < 100; ++k) {
    step(bodies, filters);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (bodies[i].kind != Kind::kObeys) continue;
      least_m = std::min(least_m, world.distance_m(bodies[i].position) - kRadius_m);
      for (std::size_t j = 0; j < bodies.size(); ++j) {
        if (i == j || bodies[j].kind == Kind::kRams) continue;
        least_m =
            std::min(least_m, (bodies[i].position - bodies[j].position).norm() - 2 * kRadius_m);
      }
    }
  }
  return least_m;
}

TEST(SafetyScenes, NoContactsInDenseGroupsCornersAndCrossings) {
  Rng rng(11);
  for (int scene = 0; scene < scenes(); ++scene) {
    const World world = *World::make(
        {{-6, -6}, {6, 6}},
        {Circle{random_place(rng, 3), uniform(rng, 0.3, 1.5)},
         *Polygon::make({{-6, -6}, {-6, uniform(rng, -5, -2)}, {uniform(rng, -5, -2), -6}})});
    std::vector<Body> bodies;
    for (int tries = 0; tries < 60 && bodies.size() < 10; ++tries) {
      const Vec2 p = random_place(rng, 5);
      if (!room_for(p, bodies, world)) continue;
      // Some swap positions, some cross at random, one in ten does not move.
      const Vec2 goal = uniform01(rng) < 0.5 ? Vec2(-p) : random_place(rng, 5);
      bodies.push_back({p, goal, uniform01(rng) < 0.1 ? Kind::kFrozen : Kind::kObeys});
    }
    ASSERT_GT(fly(bodies, world), 0.0) << "scene " << scene;
  }
}

TEST(SafetyScenes, ARobotThatRamsAtFullSpeedIsEvadedInTheOpen) {
  const World world = *World::make({{-100, -100}, {100, 100}}, {});
  Rng rng(12);
  for (int scene = 0; scene < scenes(); ++scene) {
    const double angle = uniform(rng, 0, 2 * std::numbers::pi);
    const Vec2 from = 5.0 * Vec2(std::cos(angle), std::sin(angle));
    std::vector<Body> bodies = {{Vec2::Zero(), random_place(rng, 2)},
                                {from, -20.0 * from, Kind::kRams}};
    std::vector<SafetyFilter> filters(2, SafetyFilter(world, options()));
    for (int k = 0; k < 100; ++k) {
      if (scene % 2 == 0) bodies[1].goal = bodies[0].position + 5 * bodies[0].velocity;  // pursuit
      step(bodies, filters);
      ASSERT_GT((bodies[0].position - bodies[1].position).norm(), 2 * kRadius_m)
          << "scene " << scene << " step " << k;
    }
  }
}

TEST(SafetyScenes, TwoLinesSwapThroughAGapThreeRobotsWide) {
  const World world = *World::make(
      {{-12, -3}, {12, 3}}, {*Polygon::make({{-0.2, 0.6}, {0.2, 0.6}, {0.2, 3}, {-0.2, 3}}),
                             *Polygon::make({{-0.2, -3}, {0.2, -3}, {0.2, -0.6}, {-0.2, -0.6}})});
  std::vector<Body> bodies;
  for (int i = 0; i < 5; ++i) {
    const double x = 2.0 + 1.2 * i;
    bodies.push_back({{-x, 0.02 * i}, {x + 2.0, 0.0}});
    bodies.push_back({{x, -0.02 * i}, {-x - 2.0, 0.0}});
  }
  std::vector<SafetyFilter> filters(bodies.size(), SafetyFilter(world, options()));
  for (int k = 0; k < 1200; ++k) step(bodies, filters);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_GT(bodies[i].position.x() * bodies[i].goal.x(), 0.0)
        << "robot " << i << " is not through";
  }
}

}  // namespace
}  // namespace swarm::agent
