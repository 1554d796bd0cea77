// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A planning method of one's own: the whole swarm flows through one gate, whose position is an
// option of the mission file: straight from the start to the gate and from there to the goal.
#include <algorithm>
#include <utility>
#include <vector>

#include <swarmflow/mission/option_table.hpp>
#include <swarmflow/planning/run_planner.hpp>

namespace {

using namespace swarm;
using namespace swarm::planner;

struct GateOptions {
  double gate_x_m = 0.0;
  double gate_y_m = 0.0;
  double gate_sigma_m = 1.0;
};

const auto kOptions =
    OptionTable<GateOptions>()
        .number("gate_x_m", &GateOptions::gate_x_m, between(-1e6, 1e6), "where the gate is")
        .number("gate_y_m", &GateOptions::gate_y_m, between(-1e6, 1e6), "where the gate is")
        .number("gate_sigma_m", &GateOptions::gate_sigma_m, positive(100), "spread in the gate");

class ThroughTheGate final : public PlanningMethod {
 public:
  explicit ThroughTheGate(const Mission& mission)
      : options_(kOptions.read(mission.planner.options)),
        speed_mps_(mission.planner.speed_mps),
        risk_{.alpha = mission.planner.risk_alpha, .delta_m = mission.planner.risk_delta_m} {}

  Result<PlanResult> plan(const PlanRequest& request, const PlanContext&) override {
    const Vec2 gate_m(options_.gate_x_m, options_.gate_y_m);
    if (!request.world.is_clear(gate_m, 0.0)) {
      return fail(ErrorCode::kInfeasible,
                  "the gate is in an obstacle; move planner.gate_x_m or planner.gate_y_m");
    }
    std::vector<PlanNode> nodes;
    std::vector<PlanLeg> legs;
    const auto farthest_m = [&](const Mixture& mixture) {
      double most_m = 0.0;
      for (const WeightedGaussian& c : mixture.components()) {
        most_m = std::max(most_m, (c.gaussian.mean_m() - gate_m).norm());
      }
      return most_m;
    };
    const MissionTime at_gate(farthest_m(request.start) / speed_mps_);
    const MissionTime at_goal = at_gate + MissionTime(farthest_m(request.goal) / speed_mps_);
    for (const WeightedGaussian& c : request.start.components()) {
      nodes.push_back({c.gaussian, MissionTime(0), c.weight});
    }
    const auto gate = static_cast<std::uint32_t>(nodes.size());
    const double sigma_m = options_.gate_sigma_m;
    nodes.push_back({Gaussian::from_parameters(gate_m, sigma_m, sigma_m, 0), at_gate, 1.0});
    for (std::uint32_t i = 0; i < gate; ++i) legs.push_back({i, gate, nodes[i].mass});
    for (const WeightedGaussian& c : request.goal.components()) {
      legs.push_back({gate, static_cast<std::uint32_t>(nodes.size()), c.weight});
      nodes.push_back({c.gaussian, at_goal, c.weight});
    }
    auto flow = FlowPlan::make(std::move(nodes), std::move(legs));
    if (!flow) return tl::unexpected(flow.error());
    PlanResult result;
    result.plan = *std::move(flow);
    return result;
  }

  const RiskLimit& risk() const override { return risk_; }
  void set_risk(const RiskLimit& risk) override { risk_ = risk; }

 private:
  GateOptions options_;
  double speed_mps_;
  RiskLimit risk_;
};

}  // namespace

int main(int argc, char** argv) {
  PlanningRegistry registry = builtin_planning();
  registry.add(
      {.spec = {.name = "through_the_gate",
                .doc = "All through one gate",
                .options = kOptions.specs()},
       .make = [](const MethodContext& context) -> Result<std::unique_ptr<PlanningMethod>> {
         return std::make_unique<ThroughTheGate>(context.mission);
       }});
  return run_planner(argc, argv, registry);
}
