// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A method of a guest beside the built-in ones, and the calls it gets from the keeper in flight.
#include "swarmflow/planning/planning_registry.hpp"

#include <gtest/gtest.h>

#include "tests/unit/planner_service/keeper_bench.hpp"

namespace swarm::planner {
namespace {

using std::chrono::milliseconds;

/// The calls that the guest's method received.
struct Calls {
  int plans = 0;
  int orders = 0;
  std::vector<Vec2> congestion_m;
  RiskLimit risk;
};

/// Every start component to every goal component along a straight line, in 10 s.
class StraightMethod final : public PlanningMethod {
 public:
  explicit StraightMethod(Calls& calls) : calls_(calls) {}

  Result<PlanResult> plan(const PlanRequest& request, const PlanContext&) override {
    ++calls_.plans;
    PlanResult result;
    const auto starts = static_cast<std::uint32_t>(request.start.components().size());
    std::vector<PlanNode> nodes;
    std::vector<PlanLeg> legs;
    for (const auto& [weight, gaussian] : request.start.components()) {
      nodes.push_back({gaussian, MissionTime(0), weight});
    }
    for (const auto& [weight, gaussian] : request.goal.components()) {
      for (std::uint32_t i = 0; i < starts; ++i) {
        legs.push_back({i, static_cast<std::uint32_t>(nodes.size()), weight * nodes[i].mass});
      }
      nodes.push_back({gaussian, MissionTime(10), weight});
    }
    auto flow = FlowPlan::make(std::move(nodes), std::move(legs));
    if (!flow) return tl::unexpected(flow.error());
    result.plan = *std::move(flow);
    return result;
  }
  const RiskLimit& risk() const override { return calls_.risk; }
  void set_risk(const RiskLimit& risk) override { calls_.risk = risk; }
  std::optional<Duration> replan_period() const override { return period; }
  void order_members(std::vector<RobotGroup>&, const FlowPlan&,
                     const MeasuredSwarm&) const override {
    ++calls_.orders;
  }
  bool on_congestion(const Vec2& at_m) override {
    calls_.congestion_m.push_back(at_m);
    return true;
  }

  std::optional<Duration> period;

 private:
  Calls& calls_;
};

TEST(PlanningRegistry, MakesTheMethodThatTheMissionNames) {
  PlanningRegistry registry;
  register_builtin_methods(registry);
  Calls calls;
  registry.add(PlanningEntry{
      .spec = {.name = "straight", .doc = "Straight lines", .options = {}},
      .make = [&](const MethodContext& context) -> Result<std::unique_ptr<PlanningMethod>> {
        EXPECT_EQ(context.mission.planner.method, "straight");
        EXPECT_GT(context.limits.packing_per_m2, 0.0);
        return std::make_unique<StraightMethod>(calls);
      }});
  Mission mission = test::KeeperBench::small_mission();
  mission.planner.method = "straight";

  auto planner = Planner::make(registry, mission);

  ASSERT_TRUE(planner.has_value()) << planner.error().message;
  Rng rng(1);
  EXPECT_TRUE(planner->plan({mission.world, mission.start, mission.goal}, {rng, &test::no_time})
                  .has_value());
  EXPECT_EQ(calls.plans, 1);
}

// Audits and checks ask the method what it promises, not for its name.
TEST(PlanningRegistry, BuiltInMethodsPromiseWhatTheyKeep) {
  PlanningRegistry registry;
  register_builtin_methods(registry);
  Mission mission = test::KeeperBench::small_mission();
  const auto traits = [&](const char* method) -> PlanningTraits {
    mission.planner.method = method;
    auto planner = Planner::make(registry, mission);
    EXPECT_TRUE(planner.has_value()) << method;
    return planner->method().traits();
  };
  EXPECT_EQ(traits("swarmprm").risk_promise, RiskPromise::kEveryGaussian);
  EXPECT_TRUE(traits("swarmprm").is_kept_in_time);
  EXPECT_EQ(traits("rover").risk_promise, RiskPromise::kMixture);
  EXPECT_EQ(traits("crops").risk_promise, RiskPromise::kEveryGaussian);
  EXPECT_FALSE(traits("crops").is_kept_in_time);
}

TEST(PlanningRegistry, NamesItsMethodsWhereTheMissionNamesAnother) {
  PlanningRegistry registry;
  register_builtin_methods(registry);
  Mission mission = test::KeeperBench::small_mission();
  mission.planner.method = "teleport";

  const auto planner = Planner::make(registry, mission);

  ASSERT_FALSE(planner.has_value());
  EXPECT_EQ(planner.error().code, ErrorCode::kBadInput);
  EXPECT_NE(planner.error().message.find("teleport"), std::string::npos);
  EXPECT_NE(planner.error().message.find("swarmprm, rover, crops, adoc"), std::string::npos);
  for (const ComponentSpec& spec : registry.specs()) {
    EXPECT_FALSE(spec.doc.empty()) << spec.name;
    EXPECT_EQ(spec.doc.find('\n'), std::string::npos) << spec.name;
  }
}

test::KeeperBench bench_with(Calls& calls, std::optional<Duration> period) {
  auto method = std::make_unique<StraightMethod>(calls);
  method->period = period;
  Mission mission = test::KeeperBench::small_mission();
  const auto robots = static_cast<double>(mission.robots.count);
  return {std::move(mission), Planner(std::move(method), {}, robots)};
}

TEST(PlanKeeperMethod, PlansAnewAtThePeriodOfTheMethodOnly) {
  for (const bool has_period : {true, false}) {
    Calls calls;
    auto bench =
        bench_with(calls, has_period ? std::optional<Duration>(milliseconds(500)) : std::nullopt);
    bench.run_for(0.1);
    bench.keeper.set_phase(MissionPhase::kRunning);
    bench.run_for(3.0);

    EXPECT_EQ(bench.published, has_period ? 7 : 1);
    EXPECT_EQ(calls.orders, has_period ? 6 : 0);
  }
}

TEST(PlanKeeperMethod, PassesStuckRobotsAndAllowedRiskToTheMethod) {
  Calls calls;
  auto bench = bench_with(calls, std::nullopt);
  bench.run_for(0.1);
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.run_for(7.5);
  EXPECT_TRUE(calls.congestion_m.empty());

  bench.run_for(1.0);

  ASSERT_EQ(calls.congestion_m.size(), 1U);
  EXPECT_EQ(calls.congestion_m[0], bench.positions_m[bench.positions_m.size() / 2]);
  EXPECT_EQ(bench.published, 2);
  bench.step_after(SetRisk{0.11});
  EXPECT_EQ(calls.risk.alpha, 0.11);
}

/// A plan with another number of sources would assign robots to wrong groups.
TEST(Planner, RefusesAPlanWithOtherSourcesThanTheRequest) {
  class OneSource final : public PlanningMethod {
   public:
    Result<PlanResult> plan(const PlanRequest& request, const PlanContext&) override {
      const Gaussian& from = request.start.components()[0].gaussian;
      const Gaussian& to = request.goal.components()[0].gaussian;
      PlanResult result;
      result.plan =
          FlowPlan::make({{from, MissionTime(0), 1.0}, {to, MissionTime(10), 1.0}}, {{0, 1, 1.0}})
              .value();
      return result;
    }
    const RiskLimit& risk() const override { return risk_; }
    void set_risk(const RiskLimit& risk) override { risk_ = risk; }

   private:
    RiskLimit risk_;
  };
  const Mission mission = test::KeeperBench::small_mission();
  const Gaussian& g = mission.start.components()[0].gaussian;
  const Mixture two = Mixture::make({{0.5, g}, {0.5, g}}).value();
  Planner planner(std::make_unique<OneSource>(), {}, 12.0);
  Rng rng(1);

  const auto planned = planner.plan({mission.world, two, mission.goal}, {rng, &test::no_time});

  ASSERT_FALSE(planned.has_value());
  EXPECT_NE(planned.error().message.find("1 sources"), std::string::npos)
      << planned.error().message;
}

}  // namespace
}  // namespace swarm::planner
