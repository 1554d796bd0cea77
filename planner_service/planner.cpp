// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/planner.hpp"

#include <utility>

#include <fmt/format.h>

#include "planner_service/plan_limits.hpp"
#include "planner_service/stage_timer.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

/// A method of a guest may return any flow, but robots enter the plan at a source by its index, so
/// that sources and start components have to match.
Result<void> check_sources(const FlowPlan& plan, const PlanRequest& request) {
  const std::size_t starts = request.start.components().size();
  if (plan.sources().size() == starts) return {};
  return fail(ErrorCode::kBadInput,
              fmt::format("the planning method returned a plan with {} sources for {} start "
                          "components",
                          plan.sources().size(), starts));
}

}  // namespace

Planner::Planner(std::unique_ptr<PlanningMethod> method, const SwarmLimits& limits, double robots)
    : method_(std::move(method)), limits_(limits), robots_(robots) {
  SWARM_ASSERT(method_ != nullptr);
}

Result<Planner> Planner::make(const PlanningRegistry& registry, const Mission& mission,
                              PlanningUse use) {
  auto method = registry.make(mission, use);
  if (!method) return tl::unexpected(method.error());
  return Planner(*std::move(method), swarm_limits(mission.robots, mission.safety, mission.control),
                 static_cast<double>(mission.robots.count));
}

Result<PlanResult> Planner::plan(const PlanRequest& request, const PlanContext& context) {
  StageTimer whole(context.clock);
  auto result = method_->plan(request, context);
  if (!result) return result;
  if (auto checked = check_sources(result->plan, request); !checked) {
    return tl::unexpected(checked.error());
  }
  result->stats.nodes = result->roadmap.nodes.size();
  result->stats.edges = result->roadmap.edge_count();
  result->stats.total_ms = whole.lap_ms();
  check_limits(*result, method_->traits(), limits_, robots_);
  return result;
}

// A change makes methods discard their roadmaps, so that an equal limit must not reach them.
void Planner::set_risk(const RiskLimit& risk) {
  const RiskLimit& now = method_->risk();
  if (risk.alpha == now.alpha && risk.delta_m == now.delta_m) return;
  method_->set_risk(risk);
}

}  // namespace swarm::planner
