// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>
#include <vector>

#include "swarm_link/gate/content_checks.hpp"
#include "swarm_link/gate/number_tests.hpp"
#include "swarm_link/wire_bounds.hpp"

namespace swarm::link {
namespace {

// Finite numbers first: Gaussian::make() and comparisons need them.
Checked<PlanNode> to_node(const PlanNodeMessage& node, const WireLimits& limits) {
  if (!all_finite(node.mean_x_m, node.mean_y_m, node.covariance_xx_m2, node.covariance_xy_m2,
                  node.covariance_yy_m2, node.time_s, node.mass)) {
    return refuse(RefusalReason::kNotFinite);
  }
  if (!is_inside(node.mean_x_m, node.mean_y_m, limits) || node.time_s < 0.0 ||
      node.time_s > kMaxPlanTime_s) {
    return refuse(RefusalReason::kOutOfRange);
  }
  Mat2 covariance_m2;
  covariance_m2 << node.covariance_xx_m2, node.covariance_xy_m2, node.covariance_xy_m2,
      node.covariance_yy_m2;
  const auto gaussian = Gaussian::make({node.mean_x_m, node.mean_y_m}, covariance_m2);
  if (!gaussian || !is_well_shaped(covariance_m2)) return refuse(RefusalReason::kBadGaussian);
  return PlanNode{.gaussian = *gaussian, .time = MissionTime(node.time_s), .mass = node.mass};
}

// Both ends must exist, and time must increase along a leg, so the flow has no cycle.
Checked<PlanLeg> to_leg(const PlanLegMessage& leg, const std::vector<PlanNodeMessage>& nodes) {
  if (!std::isfinite(leg.mass)) return refuse(RefusalReason::kNotFinite);
  if (leg.from_node >= nodes.size() || leg.to_node >= nodes.size() ||
      !(nodes[leg.from_node].time_s < nodes[leg.to_node].time_s)) {
    return refuse(RefusalReason::kOutOfRange);
  }
  return PlanLeg{.from = leg.from_node, .to = leg.to_node, .mass = leg.mass};
}

}  // namespace

// Checks the parts, then FlowPlan::make() checks the conservation of mass over the whole flow.
Checked<FlowPlan> check_plan(const PlanMessage& message, const WireLimits& limits) {
  if (message.schema_version != kSchemaVersion) return refuse(RefusalReason::kSchema);
  if (!fits_wire(message)) return refuse(RefusalReason::kOversized);
  std::vector<PlanNode> nodes;
  nodes.reserve(message.nodes.size());
  for (const PlanNodeMessage& node : message.nodes) {
    const auto checked = to_node(node, limits);
    if (!checked) return refuse(checked.error());
    nodes.push_back(*checked);
  }
  std::vector<PlanLeg> legs;
  legs.reserve(message.legs.size());
  for (const PlanLegMessage& leg : message.legs) {
    const auto checked = to_leg(leg, message.nodes);
    if (!checked) return refuse(checked.error());
    legs.push_back(*checked);
  }
  auto plan = FlowPlan::make(std::move(nodes), std::move(legs));
  if (!plan) return refuse(RefusalReason::kBadMass);  // everything else was checked above
  if (!std::isfinite(message.excess_m)) return refuse(RefusalReason::kNotFinite);
  if (message.entries.size() > limits.robots) return refuse(RefusalReason::kOutOfRange);
  for (const PlanEntryMessage& entry : message.entries) {
    if (entry.source != kAnySource && entry.source >= plan->sources().size()) {
      return refuse(RefusalReason::kOutOfRange);
    }
  }
  return *std::move(plan);
}

}  // namespace swarm::link
