// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/flow_plan.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "swarm_core/gmm/wasserstein.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

using namespace std::chrono_literals;

PlanNode node(double x, double time_s, double mass) {
  return {Gaussian::from_parameters({x, 0}, 1.0, 2.0, 0.3), MissionTime(time_s), mass};
}

// Two sources, a merge, a split, two sinks that arrive at different times.
std::vector<PlanNode> some_nodes() {
  return {node(0, 0, 0.25), node(1, 2, 0.75), node(10, 8, 1.0), node(20, 12, 0.6),
          node(25, 20, 0.4)};
}

std::vector<PlanLeg> some_legs() { return {{2, 4, 0.4}, {0, 2, 0.25}, {1, 2, 0.75}, {2, 3, 0.6}}; }

bool accepts(std::vector<PlanNode> nodes, std::vector<PlanLeg> legs) {
  return FlowPlan::make(std::move(nodes), std::move(legs)).has_value();
}

TEST(FlowPlan, KnowsSourcesSinksLegsAndDuration) {
  const auto plan = FlowPlan::make(some_nodes(), some_legs());

  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  EXPECT_EQ(plan->sources(), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(plan->sinks(), (std::vector<std::uint32_t>{3, 4}));
  EXPECT_EQ(plan->duration(), MissionTime(20.0));
  ASSERT_EQ(plan->legs_out(2).size(), 2U);
  EXPECT_EQ(plan->legs_out(2)[0], 0U);
  EXPECT_EQ(plan->legs_out(2)[1], 3U);
  ASSERT_EQ(plan->legs_out(0).size(), 1U);
  EXPECT_EQ(plan->legs_out(0)[0], 1U);
  EXPECT_TRUE(plan->legs_out(4).empty());
}

TEST(FlowPlan, AcceptsASwarmThatStays) { EXPECT_TRUE(accepts({node(0, 0, 1.0)}, {})); }

TEST(FlowPlan, RefusesWhatIsNoFlow) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with_node = [](std::size_t i, PlanNode changed) {
    auto nodes = some_nodes();
    nodes[i] = std::move(changed);
    return nodes;
  };
  const auto with_leg = [](std::size_t i, PlanLeg changed) {
    auto legs = some_legs();
    legs[i] = changed;
    return legs;
  };

  EXPECT_TRUE(accepts(some_nodes(), some_legs()));
  EXPECT_FALSE(accepts({}, {}));
  EXPECT_FALSE(accepts(with_node(2, node(10, nan, 1.0)), some_legs()));
  EXPECT_FALSE(accepts(with_node(2, node(10, 2, 1.0)), some_legs()));  // leg of no duration
  EXPECT_FALSE(accepts(with_node(2, node(10, 1, 1.0)), some_legs()));  // leg back in time
  EXPECT_FALSE(accepts(with_node(2, node(10, 8, 0.9)), some_legs()));  // swallows mass
  EXPECT_FALSE(accepts(with_node(2, node(10, 8, nan)), some_legs()));
  EXPECT_FALSE(accepts(with_node(2, node(10, 8, 1.1)), some_legs()));
  EXPECT_FALSE(accepts(with_node(0, node(0, 0, 0.0)), some_legs()));
  EXPECT_FALSE(accepts(with_node(0, node(0, 0, -0.25)), some_legs()));
  EXPECT_FALSE(accepts(some_nodes(), with_leg(0, {2, 5, 0.4})));  // no such node
  EXPECT_FALSE(accepts(some_nodes(), with_leg(0, {2, 2, 0.4})));  // to itself
  EXPECT_FALSE(accepts(some_nodes(), with_leg(0, {4, 2, 0.4})));
  EXPECT_FALSE(accepts(some_nodes(), with_leg(0, {2, 4, 0.3})));
  EXPECT_FALSE(accepts(some_nodes(), with_leg(0, {2, 4, nan})));
  EXPECT_FALSE(accepts(some_nodes(), with_leg(0, {2, 4, 0.0})));
  EXPECT_FALSE(accepts({node(0, 0, 0.5), node(5, 1, 0.5)}, {{0, 1, 0.5}}));  // half a swarm
  EXPECT_FALSE(accepts(std::vector<PlanNode>(FlowPlan::kMaxNodes + 1, node(0, 0, 1.0)), {}));
  EXPECT_FALSE(accepts(some_nodes(), std::vector<PlanLeg>(FlowPlan::kMaxLegs + 1, {0, 2, 0.25})));
}

TEST(FlowPlan, NamesTheNodeThatLosesMass) {
  auto legs = some_legs();
  legs[3].mass = 0.5;

  const auto plan = FlowPlan::make(some_nodes(), legs);

  ASSERT_FALSE(plan.has_value());
  EXPECT_EQ(plan.error().code, ErrorCode::kBadInput);
  EXPECT_NE(plan.error().message.find("node 2"), std::string::npos) << plan.error().message;
}

TEST(FlowPlan, MixtureKeepsAllMassAtEveryTime) {
  const auto plan = FlowPlan::make(some_nodes(), some_legs());
  ASSERT_TRUE(plan.has_value());
  Rng rng(51);
  for (int i = 0; i < 1000; ++i) {
    const Mixture mixture = plan->mixture_at(MissionTime(uniform(rng, -5.0, 25.0)));

    double sum = 0.0;
    for (const auto& component : mixture.components()) sum += component.weight;
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

TEST(FlowPlan, MixtureFollowsTheGeodesics) {
  const auto plan = FlowPlan::make(some_nodes(), some_legs());
  ASSERT_TRUE(plan.has_value());
  const auto& nodes = plan->nodes();

  const Mixture before = plan->mixture_at(-1s);
  const Mixture early = plan->mixture_at(1s);  // source 1 has not left yet
  const Mixture split = plan->mixture_at(10s);
  const Mixture after = plan->mixture_at(100s);

  ASSERT_EQ(before.components().size(), 2U);
  EXPECT_EQ(before.components()[0].gaussian.mean_m(), nodes[0].gaussian.mean_m());
  ASSERT_EQ(early.components().size(), 2U);
  EXPECT_DOUBLE_EQ(early.components()[0].weight, 0.75);
  EXPECT_EQ(early.components()[0].gaussian.mean_m(), nodes[1].gaussian.mean_m());
  EXPECT_DOUBLE_EQ(early.components()[1].gaussian.mean_m().x(), 10.0 / 8.0);
  ASSERT_EQ(split.components().size(), 2U);
  const Gaussian expected = Geodesic(nodes[2].gaussian, nodes[4].gaussian).at(2.0 / 12.0);
  EXPECT_DOUBLE_EQ(split.components()[0].weight, 0.4);
  EXPECT_EQ(split.components()[0].gaussian.mean_m(), expected.mean_m());
  EXPECT_EQ(split.components()[0].gaussian.covariance_m2(), expected.covariance_m2());
  ASSERT_EQ(after.components().size(), 2U);
  EXPECT_DOUBLE_EQ(after.components()[1].weight, 0.4);
}

TEST(FlowPlan, DigestDependsOnEveryNumber) {
  const auto digest = [](const std::vector<PlanNode>& nodes, const std::vector<PlanLeg>& legs) {
    return FlowPlan::make(nodes, legs).value().digest();
  };
  const auto original = digest(some_nodes(), some_legs());
  auto moved = some_nodes();
  moved[2].gaussian = Gaussian::from_parameters({10, 1e-9}, 1.0, 2.0, 0.3);
  auto later = some_nodes();
  later[4].time += 1e-6s;
  auto swapped = some_legs();
  std::swap(swapped[1], swapped[2]);

  EXPECT_EQ(digest(some_nodes(), some_legs()), original);
  EXPECT_NE(digest(moved, some_legs()), original);
  EXPECT_NE(digest(later, some_legs()), original);
  EXPECT_NE(digest(some_nodes(), swapped), original);
}

}  // namespace
}  // namespace swarm
