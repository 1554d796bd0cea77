// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Domain objects to messages, over the wire, through the checks and back.
#include "swarm_link/to_message.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/gate/content_checks.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

constexpr UtcTime kNow{std::chrono::seconds(1'700'000'000)};

WireLimits limits() {
  return {.robots = 100, .bounds_m = {.min_m = {0.0, 0.0}, .max_m = {50.0, 50.0}}};
}

template <class M>
M sent(const M& message) {
  std::vector<std::byte> bytes;
  EXPECT_TRUE(encode(message, bytes));
  M received;
  EXPECT_TRUE(decode(bytes, received));
  return received;
}

Vec2 any_place(Rng& rng) { return {uniform(rng, 0.0, 50.0), uniform(rng, 0.0, 50.0)}; }

Gaussian any_gaussian(Rng& rng) {
  const double a = uniform(rng, 0.1, 3.0), b = uniform(rng, 0.1, 3.0);
  const double c = uniform(rng, -0.9, 0.9) * std::sqrt(a * b);  // positive definite
  Mat2 covariance_m2;
  covariance_m2 << a, c, c, b;
  return Gaussian::make(any_place(rng), covariance_m2).value();
}

/// Layers of nodes; each but the last passes its mass on to two of the next one.
FlowPlan any_plan(Rng& rng) {
  const std::size_t layers = 2 + rng() % 4, width = 1 + rng() % 4;
  std::vector<PlanNode> nodes;
  std::vector<PlanLeg> legs;
  std::vector<double> mass(width, 1.0 / static_cast<double>(width));
  for (std::size_t layer = 0; layer < layers; ++layer) {
    for (std::size_t i = 0; i < width; ++i) {
      nodes.push_back({any_gaussian(rng), MissionTime(3.5 * static_cast<double>(layer)), mass[i]});
    }
    if (layer + 1 == layers) break;
    std::vector<double> next(width, 0.0);
    for (std::size_t i = 0; i < width; ++i) {
      const std::size_t other = (i + 1) % width;
      const double share = width == 1 ? 1.0 : uniform(rng, 0.2, 0.8);
      const auto leg = [&](std::size_t to, double part) {
        legs.push_back({static_cast<std::uint32_t>(layer * width + i),
                        static_cast<std::uint32_t>((layer + 1) * width + to), part});
        next[to] += part;
      };
      leg(i, mass[i] * share);
      if (width > 1) leg(other, mass[i] * (1.0 - share));
    }
    mass = next;
  }
  return FlowPlan::make(std::move(nodes), std::move(legs)).value();
}

TEST(PlanToMessage, ComesBackAsTheSamePlan) {
  Rng rng(61);
  for (int i = 0; i < 300; ++i) {
    const FlowPlan plan = any_plan(rng);
    const PlanMessage message = to_message(plan, PlannerEpoch(7), PlanVersion(3), kNow);
    EXPECT_EQ(message.epoch, 7U);
    EXPECT_EQ(message.version, 3U);
    EXPECT_EQ(message.t0_utc_ns, kNow.time_since_epoch().count());
    EXPECT_TRUE(message.entries.empty());

    const auto back = check_plan(sent(message), limits());

    ASSERT_TRUE(back) << to_string(back.error());
    EXPECT_EQ(back->digest(), plan.digest()) << "robots know a plan by its digest";
    EXPECT_EQ(back->sources(), plan.sources());
    EXPECT_EQ(back->sinks(), plan.sinks());
  }
}

SceneChange any_change(Rng& rng, const Scene& scene) {
  const auto obstacle = [&] { return static_cast<std::uint32_t>(rng() % (scene.next_id + 1)); };
  const auto robot = [&] { return RobotId(static_cast<std::uint32_t>(rng() % 100)); };
  switch (rng() % 7) {
    case 0:
      return AddObstacle{Circle{.center_m = any_place(rng), .radius_m = uniform(rng, 0.1, 2.0)}};
    case 1: {
      const Vec2 p = any_place(rng);
      const Vec2 right(uniform(rng, 0.5, 3.0), 0.0), up(0.0, uniform(rng, 0.5, 3.0));
      return AddObstacle{Polygon::make({p, p + right, p + right + up, p + up}).value()};
    }
    case 2:
      return MoveObstacle{.obstacle = obstacle(),
                          .by_m = any_place(rng) / 10.0,
                          .over_s = rng() % 2 == 0 ? 0.0 : uniform(rng, 0.1, 20.0)};
    case 3:
      return RemoveObstacle{.obstacle = obstacle()};
    case 4: {
      const double w = uniform(rng, 0.1, 0.9);
      return GoTo{Mixture::make({{w, any_gaussian(rng)}, {1.0 - w, any_gaussian(rng)}}).value()};
    }
    case 5:
      return SetRisk{.alpha = uniform(rng, 0.01, 0.99)};
    default:
      if (rng() % 3 == 0) return ClearBody{.robot = robot()};
      return AddBody{.robot = robot(), .shape = {.center_m = any_place(rng), .radius_m = 0.3}};
  }
}

// A scene that the launcher can make must not be refused by its receivers.
TEST(SceneToMessage, PassesTheChecksAfterAnyChangesAndComesBackTheSame) {
  Rng rng(62);
  const World world =
      World::make({{0, 0}, {50, 50}}, {Circle{.center_m = {10, 10}, .radius_m = 2.0},
                                       Polygon::make({{20, 20}, {24, 20}, {22, 25}}).value()})
          .value();
  int changes = 0;
  for (int round = 0; round < 40; ++round) {
    Scene scene = first_scene(2);
    UtcTime now = kNow;
    for (int i = 0; i < 40; ++i) {
      now += std::chrono::milliseconds(rng() % 5'000);
      const auto changed = after(scene, any_change(rng, scene), world, now);
      if (!changed) continue;  // an obstacle or body that is not there
      scene = *changed;
      ++changes;
      const SceneMessage message = to_message(scene);

      const auto back = check_scene(sent(message), limits());

      ASSERT_TRUE(back) << to_string(back.error());
      EXPECT_EQ(to_message(*back), message);
      EXPECT_EQ(back->risk_alpha, scene.risk_alpha);
      EXPECT_EQ(back->goal.has_value(), scene.goal.has_value());
      const UtcTime later = now + std::chrono::seconds(3);
      EXPECT_TRUE(world_at(world, *back, later) == world_at(world, scene, later))
          << "every process has the same map";
    }
  }
  EXPECT_GT(changes, 500);
}

}  // namespace
}  // namespace swarm::link
