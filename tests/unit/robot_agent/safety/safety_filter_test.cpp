// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/safety/safety_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

constexpr double kRadius_m = 0.2;
constexpr double kPeriod_s = 0.1;

World empty_world() { return *World::make({{-50, -50}, {50, 50}}, {}); }

SafetyOptions options() {
  return {.radius_m = kRadius_m, .speed_max_mps = 1.5, .period = std::chrono::milliseconds(100)};
}

struct Body {
  Vec2 position;
  Vec2 goal;
  Vec2 velocity = Vec2::Zero();
};

double least_gap(const std::vector<Body>& bodies) {
  double gap = 1e9;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      gap = std::min(gap, (bodies[i].position - bodies[j].position).norm() - 2 * kRadius_m);
    }
  }
  return gap;
}

/// A dense group in lock-step that knows its neighbours as they were `delay` steps ago,
/// extrapolated, with a share of the messages lost. Returns the least gap of the run.
double fly_dense_region(std::vector<Body>& bodies, const World& world, int steps, std::size_t delay,
                        double loss, Rng& rng) {
  std::vector<SafetyFilter> filters(bodies.size(), SafetyFilter(world, options()));
  struct Received {
    std::vector<Vec2> position, velocity;
    std::vector<int> step;
  };
  const std::size_t n = bodies.size();
  std::vector<Received> received(
      n,
      Received{std::vector<Vec2>(n), std::vector<Vec2>(n, Vec2::Zero()), std::vector<int>(n, -1)});
  std::deque<std::vector<Body>> past;
  double least = least_gap(bodies);
  for (int step = 0; step < steps; ++step) {
    past.push_back(bodies);
    if (past.size() > delay + 1) past.pop_front();
    const int then = step - static_cast<int>(past.size()) + 1;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        if (i == j || (received[i].step[j] >= 0 && uniform01(rng) < loss)) continue;
        received[i].position[j] = past.front()[j].position;
        received[i].velocity[j] = past.front()[j].velocity;
        received[i].step[j] = then;
      }
    }
    std::vector<Vec2> commanded(n);
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<Neighbour> neighbours;
      for (std::size_t j = 0; j < n; ++j) {
        if (i == j) continue;
        const double age = kPeriod_s * (step - received[i].step[j]);
        const Vec2 at = received[i].position[j] + age * received[i].velocity[j];
        if ((at - bodies[i].position).norm() > 6.0) continue;
        neighbours.push_back({.robot = RobotId(static_cast<std::uint32_t>(j)),
                              .position_m = at,
                              .velocity_mps = received[i].velocity[j],
                              .radius_m = kRadius_m,
                              .information_age_s = age});
      }
      const Vec2 path = bodies[i].goal - bodies[i].position;
      const Vec2 desired_velocity =
          path.norm() > 1e-9 ? Vec2(path * (std::min(1.45, 0.8 * path.norm()) / path.norm()))
                             : Vec2::Zero();
      commanded[i] = filters[i].filter(bodies[i].position, desired_velocity, neighbours);
    }
    for (std::size_t i = 0; i < n; ++i) {
      bodies[i].velocity = commanded[i];
      bodies[i].position += kPeriod_s * commanded[i];
    }
    least = std::min(least, least_gap(bodies));
  }
  return least;
}

std::vector<Body> ring(std::size_t n, double radius, Rng& rng) {
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    const Vec2 at = radius * Vec2(std::cos(angle), std::sin(angle));
    const Vec2 jitter(uniform(rng, -0.1, 0.1), uniform(rng, -0.1, 0.1));
    bodies.push_back({at + jitter, -at});
  }
  return bodies;
}

TEST(SafetyFilter, KeepsItsMarginWhenAllUpdatesArriveAtOnce) {
  const World world = empty_world();
  Rng rng(1);
  for (int round = 0; round < 20; ++round) {
    std::vector<Body> bodies = ring(12, 6.0, rng);

    const double least = fly_dense_region(bodies, world, 300, 0, 0.0, rng);

    // What β gives up in one step when the neighbour it follows stops: β v_max Δt, below the
    // margin.
    EXPECT_GT(least, 0.25 - 0.8 * 1.5 * kPeriod_s);
  }
}

TEST(SafetyFilter, NoContactsAt150MillisecondsAnd20PercentLoss) {
  const World world = empty_world();
  Rng rng(2);
  for (int round = 0; round < 20; ++round) {
    std::vector<Body> bodies = ring(12, 6.0, rng);

    const double least = fly_dense_region(bodies, world, 300, 2, 0.2, rng);

    EXPECT_GT(least, 0.0) << round;
  }
}

TEST(SafetyFilter, NeverEntersAnObstacleHoweverLateTheNextTickIs) {
  const auto wall = Polygon::make({{0, 0}, {4, 0}, {5, 3}, {2, 5}, {-1, 3}});
  ASSERT_TRUE(wall.has_value());
  const auto world = World::make({{-20, -20}, {20, 20}}, {*wall, Circle{{8, 8}, 2.0}});
  ASSERT_TRUE(world.has_value());
  SafetyFilter filter(*world, options());
  Rng rng(3);
  for (int round = 0; round < 300; ++round) {
    Vec2 position(uniform(rng, -10, 15), uniform(rng, -10, 15));
    if (world->distance_m(position) < kRadius_m + 0.05) continue;
    for (int step = 0; step < 200; ++step) {
      const double angle = uniform(rng, 0, 2 * std::numbers::pi);
      const Vec2 goal =
          step % 3 == 0 ? Vec2(2, 2) : Vec2(position + 3 * Vec2(std::cos(angle), std::sin(angle)));
      const Vec2 u = filter.filter(position, 1.5 * (goal - position).normalized(), {});
      // A command is valid for two periods: the next tick comes anywhere in between, or too late.
      position += uniform(rng, 0.0, 2.0) * kPeriod_s * u;
      ASSERT_GE(world->distance_m(position) - kRadius_m, 0.05 - 1e-9);
      ASSERT_TRUE(world->bounds_m().contains(position));
    }
  }
}

TEST(SafetyFilter, MovesApartWhatIsTooClose) {
  const World world = empty_world();
  SafetyFilter filter(world, options());
  const std::vector<Neighbour> neighbours = {{RobotId(1), {0.5, 0.0}, Vec2::Zero(), kRadius_m}};

  const Vec2 u = filter.filter({0, 0}, {1.0, 0.0}, neighbours);

  EXPECT_LT(u.x(), 0.0);
}

TEST(SafetyFilter, LeadsOutOfAWallOrAnObstacleAsFastAsItCan) {
  const auto corner = Polygon::make({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
  const World world = *World::make({{-50, -50}, {50, 50}}, {*corner});
  SafetyFilter sut(world, options());

  const Vec2 from_wall = sut.filter({-49.9, 0}, {-1, 1}, {});
  const Vec2 from_obstacle = sut.filter({-0.01, 2}, {1, 0}, {});

  EXPECT_GT(from_wall.x(), 0.0);
  EXPECT_LT(from_obstacle.x(), 0.0);
  EXPECT_LE(from_wall.norm(), options().speed_max_mps + 1e-9);
}

TEST(SafetyFilter, StopsWhenSqueezedFromBothSides) {
  const World world = empty_world();
  SafetyFilter filter(world, options());
  const std::vector<Neighbour> neighbours = {{RobotId(1), {0.45, 0.0}, Vec2::Zero(), kRadius_m},
                                             {RobotId(2), {-0.45, 0.0}, Vec2::Zero(), kRadius_m}};

  const Vec2 u = filter.filter({0, 0}, {1.0, 0.0}, neighbours);

  EXPECT_NEAR(u.x(), 0.0, 1e-9);
}

/// At (x, 0), with a gap to a robot at the origin.
Neighbour disc_at(double x, double gap_m) {
  return {.robot = RobotId(1),
          .position_m = {x, 0},
          .radius_m = std::abs(x) - gap_m - kRadius_m,
          .information_age_s = kPeriod_s,
          .is_silent = true};
}

Neighbour robot_at(const Vec2& position_m, const Vec2& velocity_mps, bool is_uncertain = false) {
  return {.robot = RobotId(2),
          .position_m = position_m,
          .velocity_mps = velocity_mps,
          .radius_m = kRadius_m,
          .information_age_s = kPeriod_s,
          .possible_stop_age_s = is_uncertain ? kPeriod_s : 0.0};
}

/// The neighbour is where it was extrapolated only if it drove on.
TEST(SafetyFilter, EntersNoDiscToKeepOffAnExtrapolatedNeighbour) {
  const World world = empty_world();
  const SafetyFilter sut(world, options());
  const Neighbour disc = disc_at(-1.1, 0.05);
  const Vec2 desired(0, 1);

  const Vec2 between =
      sut.filter({0, 0}, desired, std::array{robot_at({0.35, 0}, {-1, 0}, true), disc});
  const Vec2 away = sut.filter({0, 0}, desired, std::array{robot_at({0.35, 0}, {-1, 0}), disc});

  EXPECT_NEAR(between.x(), 0.0, 1e-6);
  EXPECT_LT(away.x(), -0.5);
}

TEST(SafetyFilter, EntersNoDiscWhenTwoNeighboursLeaveNoVelocity) {
  const World world = empty_world();
  const SafetyFilter sut(world, options());

  const Vec2 u = sut.filter(
      {0, 0}, {1.5, 0},
      std::array{robot_at({0, 0.6}, {0, 0}), robot_at({0, -0.6}, {0, 0}), disc_at(1.2, 0.1)});

  EXPECT_LE(u.x(), 0.0);
}

TEST(SafetyFilter, EvadesAnApproachingObstacle) {
  // A circle at 1 m/s towards a robot that wants to stay; it would be hit after 2 s.
  const Vec2 velocity(1.0, 0.0);
  Vec2 position(4.0, 0.3);
  for (int step = 0; step < 80; ++step) {
    const Vec2 center = kPeriod_s * step * velocity;
    const World world =
        *World::make({{-50, -50}, {50, 50}}, {Circle{center, 1.5}}, std::vector<Vec2>{velocity});
    SafetyFilter filter(world, options());
    const Vec2 u = filter.filter(position, Vec2::Zero(), {});
    position += kPeriod_s * u;
    // Where both are one period later.
    ASSERT_GE((position - center - kPeriod_s * velocity).norm() - 1.5 - kRadius_m, 0.05 - 1e-9);
  }
}

TEST(SafetyFilter, DoesNotFollowOntoOneThatMayHaveStopped) {
  const World world = empty_world();
  SafetyFilter sut(world, options());
  // Ahead, as fast as we are, last received half a second ago: a command holds for 0.2 s.
  Neighbour ahead{.robot = RobotId(1),
                  .position_m = {1.0, 0.0},
                  .velocity_mps = {1.0, 0.0},
                  .radius_m = kRadius_m,
                  .information_age_s = kPeriod_s,
                  .possible_stop_age_s = 0.0};
  const Vec2 desired_velocity(1.0, 0.0);

  EXPECT_NEAR(sut.filter(Vec2::Zero(), desired_velocity, {&ahead, 1}).x(), 1.0, 1e-9);

  ahead.possible_stop_age_s = 0.4;  // at 0.6, so that the bodies are 0.2 m apart
  const double margin_m = options().neighbour_margin_m / 3.0;
  EXPECT_NEAR(sut.filter(Vec2::Zero(), desired_velocity, {&ahead, 1}).x(),
              (0.6 - 2.0 * kRadius_m - margin_m) / (2.0 * kPeriod_s), 1e-9);
  ahead.possible_stop_age_s = 0.8;  // stopped then, it would touch us: no nearer
  EXPECT_NEAR(sut.filter(Vec2::Zero(), desired_velocity, {&ahead, 1}).x(), 0.0, 1e-9);
  // One that comes nearer is at the estimated position, or farther.
  ahead.velocity_mps = {-0.1, 0.0};
  EXPECT_GT(sut.filter(Vec2::Zero(), desired_velocity, {&ahead, 1}).x(), 0.1);
}

TEST(SafetyFilter, ComputesTheUpdateTimeoutOfFollowers) {
  const World world = empty_world();
  const SafetyFilter sut(world, options());
  Neighbour behind{.robot = RobotId(1),
                   .position_m = {-1.0, 0.0},
                   .velocity_mps = {1.0, 0.0},
                   .radius_m = kRadius_m};

  const Listeners followed = sut.listeners(Vec2::Zero(), {1.0, 0.0}, {&behind, 1});
  const Listeners met = sut.listeners(Vec2::Zero(), {-1.0, 0.0}, {&behind, 1});

  EXPECT_NEAR(followed.nearest_gap_m, 1.0 - 2.0 * kRadius_m, 1e-12);
  EXPECT_GT(met.timeout_s, 1e6);
  // After exactly that long the follower is as fast as it may be.
  Neighbour ahead{.robot = RobotId(0),
                  .position_m = {1.0, 0.0},
                  .velocity_mps = {1.0, 0.0},
                  .radius_m = kRadius_m,
                  .information_age_s = kPeriod_s,
                  .possible_stop_age_s = followed.timeout_s - 2.0 * kPeriod_s};
  SafetyFilter follower(world, options());
  EXPECT_NEAR(follower.filter(Vec2::Zero(), {1.0, 0.0}, {&ahead, 1}).x(), 1.0, 1e-9);
  ahead.possible_stop_age_s += 0.05;
  EXPECT_LT(follower.filter(Vec2::Zero(), {1.0, 0.0}, {&ahead, 1}).x(), 0.8);
}

TEST(SafetyFilter, StandingRetreatsOnlyFromOneThatApproachesAndDoesNotKeepOff) {
  const World world = empty_world();
  const SafetyFilter sut(world, options());
  // A neighbour to the right, with this gap and this velocity towards us.
  const auto stand = [&](double gap_m, double coming_mps, double possible_stop_age_s = 0.0) {
    const Neighbour n{.robot = RobotId(1),
                      .position_m = {2 * kRadius_m + gap_m, 0.0},
                      .velocity_mps = {-coming_mps, 0.0},
                      .radius_m = kRadius_m,
                      .information_age_s = kPeriod_s,
                      .possible_stop_age_s = possible_stop_age_s};
    return sut.stand(Vec2::Zero(), {&n, 1});
  };

  EXPECT_EQ(stand(0.01, 0.0), Vec2(Vec2::Zero())) << "inside the margin, but it stands";
  for (const double gap_m : {0.25, 0.4, 0.8}) {
    const double obeying_mps = 0.5 / (2.0 * kPeriod_s) * (gap_m - 0.25);
    EXPECT_EQ(stand(gap_m, obeying_mps), Vec2(Vec2::Zero())) << gap_m;
  }
  // The second line: (0.2 - 0.25 / 3) / 0.2 - 1.5.
  EXPECT_NEAR(stand(0.2, 1.5).x(), 1.0 - 1.25 / 3.0 - 1.5, 1e-9);
  EXPECT_EQ(stand(0.2, 1.5, 0.1), Vec2(Vec2::Zero())) << "it may have turned since";
}

// Both obstacles overlap the robot; the second comes towards it at 0.5 m/s.
TEST(SafetyFilter, StandingRetreatsOnlyFromObstaclesThatCome) {
  const Obstacle circle = Circle{{0.5, 0.0}, 1.0};
  const Vec2 velocity_mps(-0.5, 0.0);
  const World at_rest = World::make({{-10, -10}, {10, 10}}, {circle}).value();
  const World comes =
      World::make({{-10, -10}, {10, 10}}, {circle}, std::span(&velocity_mps, 1)).value();

  EXPECT_EQ(SafetyFilter(at_rest, options()).stand(Vec2::Zero(), {}), Vec2(Vec2::Zero()));
  EXPECT_LT(SafetyFilter(comes, options()).stand(Vec2::Zero(), {}).x(), -1.0);
  EXPECT_LT(SafetyFilter(at_rest, options()).filter(Vec2::Zero(), Vec2::Zero(), {}).x(), -1.0)
      << "one that may move withdraws";
}

}  // namespace
}  // namespace swarm::agent
