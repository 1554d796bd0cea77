// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/crops/crops_method.hpp"

#include <utility>

#include "planner_service/methods/shared/route_plan.hpp"
#include "planner_service/methods/shared/shared_keys.hpp"
#include "planner_service/stage_timer.hpp"

namespace swarm::planner {

namespace {

/// Options of crops in a mission.
struct CropsKeys : RoadmapKeys {
  double clearance_m = 0.5;
  double power = 3.0;
  double goal_radius_m = 1.0;
};

const OptionTable<CropsKeys>& crops_keys() {
  static const auto table =
      OptionTable<CropsKeys>()
          .with(roadmap_keys())
          .number("crops_clearance_m", &CropsKeys::clearance_m, between(0, 1000),
                  "nodes nearer to an obstacle are discarded")
          .number("crops_power", &CropsKeys::power, between(0, 10),
                  "p of w(q) = (sum of dist)^p; 3 in the paper, 1 in its code")
          .number("crops_goal_radius_m", &CropsKeys::goal_radius_m, between(0.1, 1000),
                  "radius of the intermediate goals; the control method crops uses it too");
  return table;
}

}  // namespace

const std::vector<OptionSpec>& CropsMethod::keys() { return crops_keys().specs(); }

CropsOptions crops_options(const Mission& mission) {
  const CropsKeys keys = crops_keys().read(mission.planner.options);
  return {.samples = keys.samples,
          .connection_radius_m = keys.connection_radius_m,
          .clearance_min_m = keys.clearance_m,
          .clearance_power = keys.power,
          .goal_radius_m = keys.goal_radius_m};
}

CropsMethod::CropsMethod(const CropsOptions& options, const RiskLimit& risk, const LegSpeed& speed)
    : options_(options), risk_(risk), speed_(speed) {}

Result<std::unique_ptr<PlanningMethod>> CropsMethod::make(const MethodContext& context) {
  const PlannerSpec& spec = context.mission.planner;
  return std::make_unique<CropsMethod>(
      crops_options(context.mission),
      RiskLimit{.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m},
      leg_speed(spec.speed_mps, context.limits));
}

/// Prepares the guide: keeps the present one with new ends while the map is the same, else samples
/// a new one, also when the present samples do not join the new ends.
Result<void> CropsMethod::prepare(const PlanRequest& request, Rng& rng) {
  if (guide_ && world_ == request.world && guide_->move_ends(request.start, request.goal)) {
    return {};
  }
  guide_.reset();
  world_ = request.world;
  auto made = CropsGuide::make(world_, request.start, request.goal, risk_, options_, rng);
  if (!made) return tl::unexpected(made.error());
  guide_.emplace(*std::move(made));
  return {};
}

// The flow of the guide's routes. They are published as they are, without smoothing.
Result<PlanResult> CropsMethod::plan(const PlanRequest& request, const PlanContext& context) {
  StageTimer stage(context.clock);
  if (auto ready = prepare(request, context.rng); !ready) return tl::unexpected(ready.error());
  PlanResult result;
  result.roadmap = guide_->roadmap();
  result.stats.roadmap_ms = stage.lap_ms();
  auto flow = flow_of(guide_->routes(), request, speed_);
  if (!flow) return tl::unexpected(flow.error());
  result.plan = *std::move(flow);
  measure_routes(result.stats, guide_->routes(), guide_->routes());
  return result;
}

// Edges and Gaussians depend on the risk limit: the guide is built again.
void CropsMethod::set_risk(const RiskLimit& risk) {
  risk_ = risk;
  guide_.reset();
}

// Makes the route nearest to the congestion costlier where robots are stuck. True if routes
// changed.
bool CropsMethod::on_congestion(const Vec2& at_m) {
  if (!guide_) return false;
  const auto route = guide_->route_near(at_m);
  return route && guide_->reweight(*route, at_m);
}

}  // namespace swarm::planner
