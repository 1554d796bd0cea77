// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/crops/crops.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/agent.hpp"

namespace swarm::agent {
namespace {

/// A wall with a gap that one robot at a time gets through, and a goal that is just large enough:
///
///   20   . . . . # . . . .
///   10   S S S     G G G
///    0   . . . . # . . . .
Mission through_a_door(std::uint32_t robots) {
  Mission m;
  const auto wall = [](double y0, double y1) {
    return Polygon::make({{14, y0}, {15, y0}, {15, y1}, {14, y1}}).value();
  };
  m.world = World::make({{0, 0}, {30, 20}}, {wall(-1, 9.5), wall(10.5, 21)}).value();
  m.robots.count = robots;
  m.control.method = "crops";
  m.start = *Mixture::make({{1.0, Gaussian::from_parameters({6, 10}, 1, 1, 0)}});
  m.goal = *Mixture::make({{1.0, Gaussian::from_parameters({24, 10}, 0.8, 0.8, 0)}});
  return m;
}

FlowPlan through_the_door(const Mission& m) {
  const auto node = [](const Gaussian& g, double time) {
    return PlanNode{g, MissionTime(time), 1.0};
  };
  const auto narrow = [](double x) { return Gaussian::from_parameters({x, 10}, 0.1, 0.1, 0); };
  return *FlowPlan::make({node(m.start.components()[0].gaussian, 0), node(narrow(13), 6),
                          node(narrow(16), 9), node(m.goal.components()[0].gaussian, 15)},
                         {{0, 1, 1}, {1, 2, 1}, {2, 3, 1}});
}

struct Swarm {
  Mission spec;
  std::vector<Agent> agents;
  std::vector<Rng> rngs;
  std::vector<Vec2> positions;
  std::vector<Vec2> velocities;
  std::vector<AgentOutput> outputs;
  std::uint32_t sequence = 0;
  Vec2 error_m = Vec2::Zero();  // of the measured position
  SteadyTime now{std::chrono::seconds(1000)};

  explicit Swarm(std::uint32_t robots) : spec(through_a_door(robots)) {
    const FlowPlan plan = through_the_door(spec);
    for (std::uint32_t i = 0; i < robots; ++i) {
      agents.emplace_back(spec.world, agent_options(spec, RobotId(i)),
                          agent_identity(spec, RobotId(i)));
      rngs.push_back(agent_rng(RobotId(i), 1));
      positions.emplace_back(4.5 + 0.8 * (i % 4), 8.4 + 0.8 * (i / 4));
      velocities.emplace_back(Vec2::Zero());
      agents.back().accept_plan(plan, positions.back());
    }
    outputs.resize(robots);
  }

  void tick() {
    ++sequence;
    for (std::size_t i = 0; i < agents.size(); ++i) {
      for (std::size_t j = 0; j < agents.size(); ++j) {
        if (i == j) continue;
        agents[i].receive(
            {RobotId(static_cast<std::uint32_t>(j)), sequence, now, positions[j], velocities[j]},
            positions[i]);
      }
      outputs[i] =
          agents[i].tick({now, positions[i] + error_m, MissionPhase::kRunning, true}, rngs[i]);
    }
    for (std::size_t i = 0; i < agents.size(); ++i) {
      velocities[i] = outputs[i].velocity_mps;
      positions[i] += 0.1 * velocities[i];
    }
    now += std::chrono::milliseconds(100);
  }

  double least_gap() const {
    double gap = 1e9;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      for (std::size_t j = i + 1; j < positions.size(); ++j) {
        gap = std::min(gap, (positions[i] - positions[j]).norm() - 0.4);
      }
    }
    return gap;
  }
};

TEST(Crops, MovesADenseGroupThroughADoorIntoAFullGoal) {
  // 20 robots with their margin take 7.4 m² at least, 40 % of the goal's 18.5 m².
  Swarm sut(20);

  int steps = 0;
  const auto all_rest = [&] {
    return std::all_of(sut.outputs.begin(), sut.outputs.end(),
                       [](const AgentOutput& o) { return o.settled; });
  };
  while (steps < 1500 && !all_rest()) {
    sut.tick();
    ++steps;
    ASSERT_GT(sut.least_gap(), 0.0);
    for (const Vec2& p : sut.positions) ASSERT_GT(sut.spec.world.distance_m(p), 0.2);
  }

  EXPECT_TRUE(all_rest()) << steps;
  for (const Vec2& p : sut.positions)
    EXPECT_TRUE(sut.spec.goal.components()[0].gaussian.contains_99(p));
}

TEST(Crops, GoesAtCruiseSpeedAndSlowsDownAtTheEnd) {
  Swarm sut(1);

  double slowest_mps = 2.0;
  for (int step = 0; step < 80; ++step) {
    sut.tick();
    slowest_mps = std::min(slowest_mps, sut.velocities[0].norm());
  }
  EXPECT_NEAR(slowest_mps, sut.spec.control.cruise_mps, 1e-9);
  while (sut.outputs[0].mode != RobotMode::kArrived) sut.tick();
  const double at_arrival_mps = sut.velocities[0].norm();
  for (int step = 0; step < 100; ++step) sut.tick();

  EXPECT_LT(at_arrival_mps, 1.0);
  EXPECT_TRUE(sut.outputs[0].settled);
  EXPECT_LT(sut.outputs[0].remaining_m, 0.2);
}

TEST(Crops, IsAtRestWhereItGoesNowhereWhateverItsNoise) {
  Swarm sut(1);
  int at_rest = 0;
  for (int step = 0; step < 400; ++step) {
    sut.error_m = Vec2(step % 2 == 0 ? 0.2 : -0.2, 0);
    sut.tick();
    at_rest += sut.outputs[0].settled ? 1 : 0;
  }

  EXPECT_GT(at_rest, 100);
  EXPECT_GT(sut.outputs[0].velocity_mps.norm(), 0.05);  // although it still moves
}

TEST(Crops, OnlyKeepsOffWhileItIsHeld) {
  Swarm sut(1);
  sut.agents[0].receive({RobotId(1), 1, sut.now, sut.positions[0] + Vec2(0.9, 0), {0, 0}},
                        sut.positions[0]);

  const AgentOutput out =
      sut.agents[0].tick({sut.now, sut.positions[0], MissionPhase::kPaused, true}, sut.rngs[0]);

  EXPECT_EQ(out.mode, RobotMode::kHolding);
  EXPECT_LT(out.velocity_mps.x(), 0.0);
  EXPECT_EQ(out.velocity_mps.y(), 0.0);
}

}  // namespace
}  // namespace swarm::agent
