// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/control_registry.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "robot_agent/agent.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "swarmflow/mission/option_table.hpp"

namespace swarm::agent {
namespace {

struct DriftOptions {
  double speed_mps = 0.5;
  std::string fault = "none";
};

const OptionTable<DriftOptions>& drift_table() {
  static const auto table =
      OptionTable<DriftOptions>()
          .number("drift_mps", &DriftOptions::speed_mps, positive(2), "speed of the drift")
          .choice("drift_fault", &DriftOptions::fault, {"none", "throw", "nan"}, "what goes wrong");
  return table;
}

/// A method that drives east and ignores the plan.
class Drift final : public ControlMethod {
 public:
  explicit Drift(const DriftOptions& options) : options_(options) {}
  void begin(const Route&, const World&) override {}
  bool has_arrived(const ControlView&) override { return false; }
  Vec2 desired_velocity(const ControlView&, bool, Rng&) override {
    if (options_.fault == "throw") throw std::runtime_error("no compass");
    if (options_.fault == "nan") return {std::numeric_limits<double>::quiet_NaN(), 0};
    return {options_.speed_mps, 0};
  }
  Vec2 hold(const ControlView&) override { return Vec2::Zero(); }
  std::uint32_t goal(const Vec2&) const override { return 0; }
  double remaining_m() const override { return 1.0; }
  std::uint32_t escapes() const override { return 0; }

 private:
  DriftOptions options_;
};

ControlRegistry with_drift() {
  ControlRegistry registry;
  register_builtin_control(registry);
  registry.add(ControlEntry{
      .spec = {.name = "drift", .doc = "Goes east", .options = drift_table().specs()},
      .prepare = [](const ControlContext& context) -> Result<PreparedControl> {
        const DriftOptions options = drift_table().read(context.options());
        return PreparedControl{.make = [options] { return ControlSlot::of<Drift>(options); }};
      }});
  return registry;
}

constexpr const char* kMission = R"(version: 1
robots: {count: 1}
world: {bounds_m: [0, 0, 60, 30]}
start: [{mean_m: [10, 15], covariance_m2: [[1, 0], [0, 1]], weight: 1}]
goal: [{mean_m: [50, 15], covariance_m2: [[1, 0], [0, 1]], weight: 1}]
control: {method: drift, drift_mps: 0.75)";

Result<Mission> mission(const std::string& more, const ControlRegistry& registry) {
  Catalogue catalogue = open_catalogue();
  catalogue.robots_are_open = false;
  catalogue.drivers = {{.name = "single_integrator", .doc = "", .options = {}}};
  catalogue.control_methods = registry.specs();
  return parse_mission(kMission + more + "}\n", "m.yaml", {}, catalogue);
}

/// The robot of such a mission after a second under way.
struct Flown {
  AgentOutput output;
  std::string fault;
};

Flown fly(const std::string& more) {
  const ControlRegistry registry = with_drift();
  const Mission spec = *mission(more, registry);
  const AgentOptionsOf options = *AgentOptionsOf::make(spec, registry);
  Agent agent(spec.world, options(RobotId(0)), agent_identity(spec, RobotId(0)));
  const auto node = [](const Gaussian& gaussian, double time_s) {
    return PlanNode{gaussian, MissionTime(time_s), 1.0};
  };
  agent.accept_plan(*FlowPlan::make({node(spec.start.components()[0].gaussian, 0),
                                     node(spec.goal.components()[0].gaussian, 40)},
                                    {{0, 1, 1}}),
                    {10, 15});
  Rng rng(1);
  Flown flown;
  SteadyTime now{std::chrono::seconds(1000)};
  for (int tick = 0; tick < 10; ++tick) {
    flown.output = agent.tick({.now = now,
                               .position_m = {10, 15},
                               .phase = MissionPhase::kRunning,
                               .planner_alive = true},
                              rng);
    now += std::chrono::milliseconds(100);
  }
  flown.fault = agent.control_fault();
  return flown;
}

TEST(ControlRegistry, RunsAMethodAddedByAUser) {
  const Flown flown = fly("");
  EXPECT_EQ(flown.output.mode, RobotMode::kMoving);
  EXPECT_EQ(flown.output.velocity_mps, Vec2(0.75, 0));
  EXPECT_EQ(flown.fault, "");
}

TEST(ControlRegistry, ChecksTheKeysOfItsMethodsWithLineAndColumn) {
  const ControlRegistry registry = with_drift();
  const auto error = [&](const std::string& more) {
    return mission(more, registry).error().message;
  };

  EXPECT_EQ(error(", drift_fault: sometimes"),
            "m.yaml:6:56: control.drift_fault is \"sometimes\"; must be one of: none, throw, nan");
  EXPECT_EQ(error(", drift_fualt: nan"),
            "m.yaml:6:43: unknown key control.drift_fualt; did you mean control.drift_fault?");
}

TEST(ControlRegistry, WritesTheKeysOfItsMethods) {
  const ControlRegistry registry = with_drift();
  const Mission before = *mission(", drift_fault: nan", registry);
  Catalogue catalogue = open_catalogue();
  catalogue.robots_are_open = false;
  catalogue.drivers = {{.name = "single_integrator", .doc = "", .options = {}}};
  catalogue.control_methods = registry.specs();
  const Mission after = *parse_mission(to_yaml(before), "again.yaml", {}, catalogue);
  EXPECT_EQ(after.control.options, before.control.options);
  EXPECT_EQ(after.control.options.number("drift_mps"), 0.75);
}

TEST(ControlRegistry, RefusesAMethodThatItDoesNotHave) {
  const Mission spec = *mission("", with_drift());
  const auto options = AgentOptionsOf::make(spec, builtin_control());
  ASSERT_FALSE(options);
  EXPECT_EQ(options.error().message,
            "control.method is drift; this program has apf, crops, intermittent_diffusion");
}

TEST(ControlRegistry, StopsARobotWhoseMethodThrows) {
  const Flown flown = fly(", drift_fault: throw");
  EXPECT_EQ(flown.output.mode, RobotMode::kStopped);
  EXPECT_EQ(flown.output.velocity_mps, Vec2::Zero());
  EXPECT_EQ(flown.fault, "the control method threw: no compass");
}

TEST(ControlRegistry, StopsARobotWhoseMethodReturnsNoVelocity) {
  const Flown flown = fly(", drift_fault: nan");
  EXPECT_EQ(flown.output.mode, RobotMode::kStopped);
  EXPECT_EQ(flown.output.velocity_mps, Vec2::Zero());
  EXPECT_EQ(flown.fault, "the control method returned a velocity that is not finite");
}

}  // namespace
}  // namespace swarm::agent
