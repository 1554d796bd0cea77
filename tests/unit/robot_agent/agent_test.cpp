// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/agent.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <new>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/safety/safety_filter.hpp"

namespace {
std::size_t allocations = 0;
}  // namespace

// Counts what the control loop must not do. Not inlined, as g++ then takes free() for the wrong
// partner of new.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace swarm::agent {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds(100);

/// A corridor with a block in it, one start and one goal Gaussian.
Mission mission(std::uint32_t robots) {
  Mission m;
  m.world =
      *World::make({{0, 0}, {60, 30}}, {*Polygon::make({{25, 0}, {35, 0}, {35, 12}, {25, 12}})});
  m.robots.count = robots;
  m.start = *Mixture::make({{1.0, Gaussian::from_parameters({10, 8}, 2, 2, 0)}});
  m.goal = *Mixture::make({{1.0, Gaussian::from_parameters({50, 8}, 2, 2, 0)}});
  return m;
}

FlowPlan plan_over_the_block() {
  const auto node = [](Vec2 mean, double sigma, double time) {
    return PlanNode{Gaussian::from_parameters(mean, sigma, sigma, 0), MissionTime(time), 1.0};
  };
  return *FlowPlan::make(
      {node({10, 8}, 2, 0), node({24, 20}, 1.5, 15), node({36, 20}, 1.5, 25), node({50, 8}, 2, 40)},
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
  SteadyTime now{std::chrono::seconds(1000)};

  explicit Swarm(std::uint32_t robots) : spec(mission(robots)) {
    for (std::uint32_t i = 0; i < robots; ++i) {
      agents.emplace_back(spec.world, agent_options(spec, RobotId(i)),
                          agent_identity(spec, RobotId(i)));
      rngs.push_back(agent_rng(RobotId(i), 1));
      positions.emplace_back(8.0 + 1.2 * (i % 4), 5.0 + 1.2 * (i / 4));
      velocities.emplace_back(Vec2::Zero());
    }
    outputs.resize(robots);
  }

  void tick(MissionPhase phase, bool planner_alive) {
    ++sequence;
    for (std::size_t i = 0; i < agents.size(); ++i) {
      for (std::size_t j = 0; j < agents.size(); ++j) {
        if (i == j) continue;
        agents[i].receive(
            {RobotId(static_cast<std::uint32_t>(j)), sequence, now, positions[j], velocities[j]},
            positions[i]);
      }
      outputs[i] = agents[i].tick({now, positions[i], phase, planner_alive}, rngs[i]);
    }
    for (std::size_t i = 0; i < agents.size(); ++i) {
      velocities[i] = outputs[i].velocity_mps;
      positions[i] += 0.1 * velocities[i];
    }
    now += kPeriod;
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

TEST(Agent, MovesADenseGroupAroundTheBlockWithoutContact) {
  Swarm sut(20);
  for (std::size_t i = 0; i < sut.agents.size(); ++i)
    sut.agents[i].accept_plan(plan_over_the_block(), sut.positions[i]);

  int steps = 0;
  const auto all_arrived = [&] {
    return std::all_of(sut.outputs.begin(), sut.outputs.end(),
                       [](const AgentOutput& o) { return o.mode == RobotMode::kArrived; });
  };
  while (steps < 1500 && !all_arrived()) {
    sut.tick(MissionPhase::kRunning, true);
    ++steps;
    ASSERT_GT(sut.least_gap(), 0.0);
    for (const Vec2& p : sut.positions) ASSERT_GT(sut.spec.world.distance_m(p), 0.2);
  }

  EXPECT_TRUE(all_arrived()) << steps;
  for (const Vec2& p : sut.positions)
    EXPECT_TRUE(sut.spec.goal.components()[0].gaussian.contains_99(p));
}

/// Another flow, from two groups in the middle of the first one, under the block's upper edge.
FlowPlan plan_from_the_middle() {
  const auto node = [](Vec2 mean, double sigma, double time, double mass) {
    return PlanNode{Gaussian::from_parameters(mean, sigma, sigma, 0), MissionTime(time), mass};
  };
  return *FlowPlan::make({node({16, 12}, 1, 0, 0.5), node({20, 16}, 1, 0, 0.5),
                          node({30, 24}, 1.5, 15, 1), node({50, 8}, 2, 40, 1)},
                         {{0, 2, 0.5}, {1, 2, 0.5}, {2, 3, 1}});
}

TEST(Agent, ChangesOverToAnotherPlanWithoutAJump) {
  Swarm sut(20);
  for (std::size_t i = 0; i < sut.agents.size(); ++i)
    sut.agents[i].accept_plan(plan_over_the_block(), sut.positions[i]);
  for (int step = 0; step < 80; ++step) sut.tick(MissionPhase::kRunning, true);

  // By the planner's entry or, for every third, without one: the path begins where the robot is.
  for (std::size_t i = 0; i < sut.agents.size(); ++i) {
    std::optional<PlanEntry> entry;
    if (i % 3 != 0) entry = PlanEntry{static_cast<std::uint32_t>(i % 2), 0.5};
    sut.agents[i].accept_plan(plan_from_the_middle(), sut.positions[i], entry);
    EXPECT_LT((sut.agents[i].route_begin_m() - sut.positions[i]).norm(), 1e-6);
  }
  int steps = 0;
  const auto all_arrived = [&] {
    return std::all_of(sut.outputs.begin(), sut.outputs.end(),
                       [](const AgentOutput& o) { return o.mode == RobotMode::kArrived; });
  };
  for (; steps < 1500 && !all_arrived(); ++steps) {
    sut.tick(MissionPhase::kRunning, true);
    ASSERT_GT(sut.least_gap(), 0.0);
    for (const Vec2& p : sut.positions) ASSERT_GT(sut.spec.world.distance_m(p), 0.2);
  }
  EXPECT_TRUE(all_arrived()) << steps;
}

TEST(Agent, DoesNotGoBackToWhereItsGroupWasWhenItComesBackLate) {
  Swarm sut(1);
  sut.positions[0] = {45.0, 12.0};  // long past both sources of the plan
  sut.agents[0].accept_plan(plan_from_the_middle(), sut.positions[0], PlanEntry{0, 0.5});

  double least_x_m = 45.0;
  for (int step = 0; step < 150; ++step) {
    sut.tick(MissionPhase::kRunning, true);
    least_x_m = std::min(least_x_m, sut.positions[0].x());
  }

  EXPECT_EQ(sut.outputs[0].mode, RobotMode::kArrived);
  EXPECT_GT(least_x_m, 44.0);
}

TEST(Agent, DoesNotGoBackToItsStartWhenItIsRespawned) {
  Swarm sut(1);
  AgentIdentity self = agent_identity(sut.spec, RobotId(0));
  self.underway = true;
  sut.agents.clear();
  sut.agents.emplace_back(sut.spec.world, agent_options(sut.spec, RobotId(0)), self);
  sut.positions[0] = {37.5, 10};  // behind the block: in sight of the goal, not of the start
  sut.agents[0].accept_plan(plan_over_the_block(), sut.positions[0]);

  for (int i = 0; i < 300; ++i) sut.tick(MissionPhase::kRunning, true);

  EXPECT_EQ(sut.outputs[0].mode, RobotMode::kArrived);
}

TEST(Agent, KeepsItsSlotInTheGoalWhenItIsPlannedFromAnotherGroup) {
  Swarm sut(1);
  sut.positions[0] = {46.0, 10.0};
  const Gaussian goal = Gaussian::from_parameters({50, 8}, 2, 2, 0);
  const auto from = [&](const Vec2& mean_m, double sigma_m) {
    const Gaussian group = Gaussian::from_parameters(mean_m, sigma_m, sigma_m, 0);
    return *FlowPlan::make({{group, MissionTime(0), 1.0}, {goal, MissionTime(5), 1.0}},
                           {{0, 1, 1.0}});
  };
  sut.agents[0].accept_plan(from({46, 10}, 1), sut.positions[0], PlanEntry{0, 0.5});
  for (int step = 0; step < 100; ++step) sut.tick(MissionPhase::kRunning, true);
  ASSERT_EQ(sut.outputs[0].mode, RobotMode::kArrived);
  const Vec2 slot_m = sut.positions[0];

  // By this plan alone it would go to the other side of the goal.
  sut.agents[0].accept_plan(from(slot_m + Vec2(2, 2), 1), slot_m, PlanEntry{0, 0.5});
  for (int step = 0; step < 100; ++step) sut.tick(MissionPhase::kRunning, true);

  EXPECT_EQ(sut.outputs[0].mode, RobotMode::kArrived);
  EXPECT_LT((sut.positions[0] - slot_m).norm(), 0.2);
}

TEST(Agent, StaysWhereItArrivedWhenThePlanLeavesItThere) {
  Swarm sut(1);
  sut.positions[0] = {49.0, 9.0};
  const Gaussian home = Gaussian::from_parameters({50, 8}, 2, 2, 0);
  const FlowPlan plan =
      *FlowPlan::make({{home, MissionTime(0), 1.0}, {home, MissionTime(1), 1.0}}, {{0, 1, 1.0}});
  sut.agents[0].accept_plan(plan, sut.positions[0], PlanEntry{0, 0.5});

  for (int step = 0; step < 20; ++step) sut.tick(MissionPhase::kRunning, true);

  EXPECT_EQ(sut.outputs[0].mode, RobotMode::kArrived);
  EXPECT_LT((sut.positions[0] - Vec2(49.0, 9.0)).norm(), 0.1);
}

TEST(Agent, ReportsTheMeasuredVelocityIfItDiffersFromTheCommand) {
  Swarm sut(1);
  sut.agents[0].accept_plan(plan_over_the_block(), sut.positions[0]);
  AgentInput input{sut.now, sut.positions[0], MissionPhase::kRunning, true};
  const AgentOutput obeys = sut.agents[0].tick(input, sut.rngs[0]);
  input.velocity_mps = Vec2(0.1, -0.2);
  const AgentOutput lags = sut.agents[0].tick(input, sut.rngs[0]);

  EXPECT_EQ(obeys.reported_mps, obeys.velocity_mps);
  EXPECT_EQ(lags.reported_mps, Vec2(0.1, -0.2));
}

TEST(Agent, WaitsUntilTheMissionStarts) {
  Swarm sut(1);
  sut.tick(MissionPhase::kRunning, true);
  EXPECT_EQ(sut.outputs[0].mode, RobotMode::kWaiting);  // no plan

  sut.agents[0].accept_plan(plan_over_the_block(), sut.positions[0]);
  sut.tick(MissionPhase::kReady, true);

  EXPECT_EQ(sut.outputs[0].mode, RobotMode::kWaiting);
  EXPECT_EQ(sut.outputs[0].velocity_mps, Vec2::Zero());
}

TEST(Agent, HoldsWithoutHeartbeatsAndContinuesWhenTheyResume) {
  Swarm sut(1);
  sut.agents[0].accept_plan(plan_over_the_block(), sut.positions[0]);
  sut.tick(MissionPhase::kRunning, true);
  EXPECT_GT(sut.outputs[0].velocity_mps.norm(), 1.0);

  sut.tick(MissionPhase::kRunning, false);
  EXPECT_EQ(sut.outputs[0].mode, RobotMode::kHolding);
  EXPECT_EQ(sut.outputs[0].velocity_mps, Vec2::Zero());

  sut.tick(MissionPhase::kRunning, true);
  EXPECT_EQ(sut.outputs[0].mode, RobotMode::kMoving);
}

TEST(Agent, EvadesWhileItHolds) {
  Swarm sut(1);
  sut.agents[0].accept_plan(plan_over_the_block(), sut.positions[0]);
  sut.tick(MissionPhase::kRunning, true);
  sut.agents[0].receive({RobotId(0), 1, sut.now, sut.positions[0] + Vec2(0.5, 0), {-1, 0}},
                        sut.positions[0]);

  const AgentOutput out =
      sut.agents[0].tick({sut.now, sut.positions[0], MissionPhase::kPaused, true}, sut.rngs[0]);

  EXPECT_EQ(out.mode, RobotMode::kHolding);
  EXPECT_LT(out.velocity_mps.x(), 0.0);
}

TEST(Agent, StaysStoppedAfterAnEmergencyStop) {
  Swarm sut(2);
  for (std::size_t i = 0; i < 2; ++i)
    sut.agents[i].accept_plan(plan_over_the_block(), sut.positions[i]);
  sut.tick(MissionPhase::kRunning, true);

  sut.tick(MissionPhase::kStopped, true);

  for (const AgentOutput& o : sut.outputs) {
    EXPECT_EQ(o.mode, RobotMode::kStopped);
    EXPECT_EQ(o.velocity_mps, Vec2::Zero());
  }
}

TEST(Agent, KeepsItsProgressWhenTheSamePlanIsPublishedAgain) {
  Swarm sut(1);
  sut.agents[0].accept_plan(plan_over_the_block(), sut.positions[0]);
  for (int i = 0; i < 100; ++i) sut.tick(MissionPhase::kRunning, true);
  const double before = sut.outputs[0].remaining_m;

  sut.agents[0].accept_plan(plan_over_the_block(), sut.positions[0]);
  sut.tick(MissionPhase::kRunning, true);

  EXPECT_LE(sut.outputs[0].remaining_m, before);
}

TEST(Agent, FindsAnotherPathInTheSamePlanWhenABodyLiesOnItsOwn) {
  Swarm sut(1);
  const FlowPlan plan = plan_over_the_block();
  EXPECT_TRUE(sut.agents[0].accept_plan(plan, sut.positions[0]));
  for (int i = 0; i < 60; ++i) sut.tick(MissionPhase::kRunning, true);
  const auto put_body_m = [&](const Vec2& center_m) {
    std::vector<Obstacle> obstacles = mission(1).world.obstacles();
    obstacles.emplace_back(Circle{center_m, 0.3});
    sut.spec.world = *World::make(sut.spec.world.bounds_m(), obstacles, {}, 1);
  };
  const Vec2 ahead = sut.velocities[0].normalized();
  put_body_m(sut.positions[0] - 2.0 * ahead);
  EXPECT_FALSE(sut.agents[0].accept_plan(plan, sut.positions[0])) << "it is behind the robot";

  const Vec2 body_m = sut.positions[0] + 4.0 * ahead;
  put_body_m(body_m);
  EXPECT_TRUE(sut.agents[0].accept_plan(plan, sut.positions[0], PlanEntry{0, 0.5}));
  EXPECT_FALSE(sut.agents[0].accept_plan(plan, sut.positions[0])) << "that path is free";

  double gap_m = 1e9;
  for (int i = 0; i < 900 && sut.outputs[0].mode != RobotMode::kArrived; ++i) {
    sut.tick(MissionPhase::kRunning, true);
    gap_m = std::min(gap_m, (sut.positions[0] - body_m).norm() - 0.5);
  }
  EXPECT_EQ(sut.outputs[0].mode, RobotMode::kArrived);
  EXPECT_GT(gap_m, 0.2);
}

TEST(Agent, DoesTheSameForTheSameInputs) {
  Swarm a(8);
  Swarm b(8);
  for (Swarm* s : {&a, &b}) {
    for (std::size_t i = 0; i < 8; ++i)
      s->agents[i].accept_plan(plan_over_the_block(), s->positions[i]);
    for (int i = 0; i < 300; ++i) s->tick(MissionPhase::kRunning, true);
  }

  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(a.positions[i], b.positions[i]);
}

TEST(Agent, DoesNotAllocateOnceWarm) {
  Swarm sut(20);
  for (std::size_t i = 0; i < sut.agents.size(); ++i)
    sut.agents[i].accept_plan(plan_over_the_block(), sut.positions[i]);
  for (int i = 0; i < 50; ++i) sut.tick(MissionPhase::kRunning, true);

  const std::size_t before = allocations;
  for (int i = 0; i < 100; ++i) sut.tick(MissionPhase::kRunning, true);

  EXPECT_EQ(allocations - before, 0U);
}

TEST(Agent, BetweenADiscAndANeighbourDoesNotAllocateOnceWarm) {
  const World world = *World::make({{-50, -50}, {50, 50}}, {});
  const SafetyFilter sut(world, SafetyOptions{.period = std::chrono::milliseconds(100)});
  const std::array neighbours{
      Neighbour{.robot = RobotId(1), .position_m = {0.35, 0}, .radius_m = 0.2},
      Neighbour{.robot = RobotId(2), .position_m = {-1.1, 0}, .radius_m = 0.85, .is_silent = true}};
  sut.filter({0, 0}, {0, 1}, neighbours, true);

  const std::size_t before = allocations;
  sut.filter({0, 0}, {0, 1}, neighbours, true);

  EXPECT_EQ(allocations - before, 0U);
}

}  // namespace
}  // namespace swarm::agent
