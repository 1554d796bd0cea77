// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/apf/diffusion_escape.hpp"

#include <gtest/gtest.h>

#include "robot_agent/methods/apf/obstacle_repulsion.hpp"

namespace swarm::agent {
namespace {

constexpr double kPeriod_s = 0.1;

/// A robot that flows straight to (8, 0) from inside a U that opens to the left.
struct Trapped {
  World world = *World::make(
      {{-10, -10}, {12, 10}},
      {*Polygon::make(
          {{-2, -2}, {2.4, -2}, {2.4, 2}, {-2, 2}, {-2, 1.6}, {2, 1.6}, {2, -1.6}, {-2, -1.6}})});
  Vec2 position_m{0, 0};
  Vec2 goal_m{8, 0};
  Rng rng{7};

  /// Whether it gets there within ten minutes.
  bool arrives(DiffusionEscape* escape) {
    SteadyTime now{std::chrono::seconds(100)};
    for (int step = 0; step < 6000; ++step, now += from_seconds(kPeriod_s)) {
      if ((goal_m - position_m).norm() < 0.3) return true;
      const ControlView view{now, position_m, {}, world};
      Vec2 aim = goal_m;
      if (escape != nullptr) {
        const double progress_m = 20.0 - (goal_m - position_m).norm();
        aim = escape->update(view, progress_m, true, rng).value_or(aim);
      }
      Vec2 u =
          1.5 * (aim - position_m).normalized() +
          obstacle_repulsion(position_m, world, {.radius_m = 0.2, .gap_m = 0.3, .push_mps = 2});
      const Vec2 next = position_m + kPeriod_s * u;
      if (world.segment_is_free(position_m, next, 0.2)) position_m = next;
    }
    return false;
  }
};

EscapeOptions options() {
  return {.stuck_after = std::chrono::seconds(2), .duration = std::chrono::seconds(5)};
}

TEST(DiffusionEscape, FreesARobotFromAU) {
  Trapped robot;
  DiffusionEscape escape(options());

  EXPECT_TRUE(robot.arrives(&escape));
  EXPECT_GT(escape.escapes(), 0U);
}

TEST(DiffusionEscape, ARobotStaysInAUWithoutIt) {
  Trapped robot;

  EXPECT_FALSE(robot.arrives(nullptr));
}

TEST(DiffusionEscape, IgnoresRobotsThatProgressOrDoNotWantToMove) {
  const World world = *World::make({{-10, -10}, {10, 10}}, {});
  DiffusionEscape escape(options());
  Rng rng(1);
  SteadyTime now{std::chrono::seconds(100)};

  for (int step = 0; step < 200; ++step, now += from_seconds(kPeriod_s)) {
    const ControlView view{now, Vec2::Zero(), {}, world};
    EXPECT_FALSE(escape.update(view, 0.05 * step, true, rng).has_value());
  }
  for (int step = 0; step < 200; ++step, now += from_seconds(kPeriod_s)) {
    const ControlView view{now, Vec2::Zero(), {}, world};
    EXPECT_FALSE(escape.update(view, 0.0, false, rng).has_value());
  }
}

}  // namespace
}  // namespace swarm::agent
