// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/timed_plan.hpp"

#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

constexpr double kStep_s = 3.0;

// Gaussians in a row, so that each can be recognised by its mean.
std::vector<Gaussian> row(std::size_t count) {
  std::vector<Gaussian> nodes;
  for (std::size_t i = 0; i < count; ++i) {
    nodes.push_back(Gaussian::from_parameters({10.0 * static_cast<double>(i), 0}, 1, 1, 0));
  }
  return nodes;
}

const std::vector<double> kOne{1.0};

// Start 0, goal 1, and node 2 between them, which half of the swarm passes at step 2 and the other
// half at step 4; what has arrived first waits at the goal.
std::vector<TimedMove> two_waves() {
  return {{0, 0, 2, 2, 0.5}, {0, 0, 0, 1, 0.5}, {0, 1, 0, 2, 0.5}, {0, 2, 2, 4, 0.5},
          {2, 2, 1, 4, 0.5}, {2, 4, 1, 6, 0.5}, {1, 4, 1, 5, 0.5}, {1, 5, 1, 6, 0.5}};
}

// (roadmap node, step) of a node of the plan.
std::pair<std::uint32_t, int> place(const TimedPlan& timed, std::uint32_t node) {
  return {timed.roadmap_node[node],
          static_cast<int>(timed.plan.nodes()[node].time.count() / kStep_s + 0.5)};
}

using Place = std::pair<std::uint32_t, int>;

std::vector<std::pair<Place, Place>> sorted_legs(const TimedPlan& timed) {
  std::vector<std::pair<Place, Place>> legs;
  for (const PlanLeg& leg : timed.plan.legs()) {
    EXPECT_EQ(leg.mass, 0.5);
    legs.emplace_back(place(timed, leg.from), place(timed, leg.to));
  }
  std::sort(legs.begin(), legs.end());
  return legs;
}

TEST(TimedPlan, MergesWaitingBetweenTwoEventsIntoOneLeg) {
  const auto timed = timed_plan(row(3), kOne, kOne, two_waves(), kStep_s);

  ASSERT_TRUE(timed.has_value()) << timed.error().message;
  const std::vector<std::pair<Place, Place>> expected{{{0, 0}, {0, 2}}, {{0, 0}, {2, 2}},
                                                      {{0, 2}, {2, 4}}, {{1, 4}, {1, 6}},
                                                      {{2, 2}, {1, 4}}, {{2, 4}, {1, 6}}};
  EXPECT_EQ(sorted_legs(*timed), expected);
  EXPECT_EQ(timed->plan.sources(), std::vector<std::uint32_t>{0});
  EXPECT_EQ(timed->plan.sinks(), std::vector<std::uint32_t>{1});
  EXPECT_EQ(timed->plan.nodes()[0].mass, 1.0);
  EXPECT_EQ(timed->plan.nodes()[1].mass, 1.0);
  EXPECT_EQ(timed->plan.duration(), MissionTime(6 * kStep_s));
}

TEST(TimedPlan, HasTheGaussiansOfTheRoadmap) {
  const std::vector<Gaussian> nodes = row(3);

  const auto timed = timed_plan(nodes, kOne, kOne, two_waves(), kStep_s);

  ASSERT_TRUE(timed.has_value());
  ASSERT_EQ(timed->roadmap_node.size(), timed->plan.nodes().size());
  for (std::size_t i = 0; i < timed->roadmap_node.size(); ++i) {
    EXPECT_EQ(timed->plan.nodes()[i].gaussian.mean_m(), nodes[timed->roadmap_node[i]].mean_m());
  }
}

TEST(TimedPlan, IsTheSameFlowInWhateverOrderTheMovesCome) {
  const auto expected = sorted_legs(timed_plan(row(3), kOne, kOne, two_waves(), kStep_s).value());
  Rng rng(1);
  for (int i = 0; i < 50; ++i) {
    std::vector<TimedMove> moves = two_waves();
    std::shuffle(moves.begin(), moves.end(), rng);

    const auto timed = timed_plan(row(3), kOne, kOne, std::move(moves), kStep_s);

    ASSERT_TRUE(timed.has_value()) << timed.error().message;
    EXPECT_EQ(sorted_legs(*timed), expected);
  }
}

TEST(TimedPlan, LeavesOutWhatRoundingMoves) {
  const auto clean = timed_plan(row(5), kOne, kOne, two_waves(), kStep_s);
  std::vector<TimedMove> moves = two_waves();
  moves.push_back({0, 0, 3, 1, 5e-10});  // too little
  moves.push_back({3, 1, 1, 3, 2e-9});   // enough, but what leads here is left out
  moves.push_back({0, 1, 4, 2, 2e-9});   // enough, but what leads on from here is left out
  moves.push_back({4, 2, 1, 5, 5e-10});

  const auto timed = timed_plan(row(5), kOne, kOne, moves, kStep_s);

  ASSERT_TRUE(timed.has_value()) << timed.error().message;
  EXPECT_EQ(timed->plan.nodes().size(), clean->plan.nodes().size());
  for (const std::uint32_t node : timed->roadmap_node) EXPECT_LT(node, 3U);
}

TEST(TimedPlan, ClosesAGoalOneStepAfterTheLastMassPassedThroughIt) {
  // All mass reaches goal 1 at step 2, half of it goes on to goal 2.
  const std::vector<TimedMove> moves{
      {0, 0, 1, 2, 1.0}, {1, 2, 2, 4, 0.5}, {1, 2, 1, 3, 0.5}, {1, 3, 1, 4, 0.5}};

  const auto timed = timed_plan(row(3), kOne, std::vector<double>{0.5, 0.5}, moves, kStep_s);

  ASSERT_TRUE(timed.has_value()) << timed.error().message;
  ASSERT_EQ(timed->plan.sinks(), (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(place(*timed, 1), std::pair(1U, 3));
  EXPECT_EQ(place(*timed, 2), std::pair(2U, 4));
  EXPECT_EQ(timed->plan.nodes()[1].mass, 0.5);
}

TEST(TimedPlan, KeepsTheOrderOfStartsAndGoals) {
  // Start 1 leaves first and its goal 3 is reached first; the indices follow the components.
  const std::vector<TimedMove> moves{
      {1, 0, 3, 1, 0.25}, {0, 0, 0, 1, 0.75}, {0, 1, 2, 5, 0.75}, {3, 1, 3, 2, 0.25}};

  const auto timed = timed_plan(row(4), std::vector<double>{0.75, 0.25},
                                std::vector<double>{0.75, 0.25}, moves, kStep_s);

  ASSERT_TRUE(timed.has_value()) << timed.error().message;
  EXPECT_EQ(timed->plan.sources(), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(timed->plan.sinks(), (std::vector<std::uint32_t>{2, 3}));
  for (const std::uint32_t i : {0U, 1U, 2U, 3U}) EXPECT_EQ(timed->roadmap_node[i], i);
  EXPECT_EQ(timed->plan.nodes()[2].mass, 0.75);
  EXPECT_EQ(timed->plan.nodes()[3].time, MissionTime(kStep_s));
}

TEST(TimedPlan, RefusesWhatNoMessageHolds) {
  constexpr std::uint32_t kBetween = 5000;
  std::vector<TimedMove> moves;
  for (std::uint32_t i = 0; i < kBetween; ++i) {
    moves.push_back({0, 0, 2 + i, 1, 1.0 / kBetween});
    moves.push_back({2 + i, 1, 1, 2, 1.0 / kBetween});
  }

  const auto timed = timed_plan(row(2 + kBetween), kOne, kOne, std::move(moves), kStep_s);

  ASSERT_FALSE(timed.has_value());
  EXPECT_EQ(timed.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace swarm::planner
