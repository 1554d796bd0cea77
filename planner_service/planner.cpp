// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "planner_service/plan_routes.hpp"
#include "planner_service/stage_timer.hpp"
#include "planner_service/swarmprm.hpp"
#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

constexpr int kFineGrid = 200;

constexpr std::array<std::pair<std::string_view, Method>, 2> kMethods{
    {{"swarmprm", Method::kSwarmPrm}, {"crops", Method::kCrops}}};

}  // namespace

/// What the methods keep; they refer to the world of the last request, which is kept with them.
struct Planner::Memory {
  World world;
  std::optional<CropsGuide> guide;

  Result<PlanResult> plan_crops(const PlanRequest& request, const PlannerOptions& options, Rng& rng,
                                const StageClock& clock);
};

/// The graph is kept while the map is the same: so are the edges that were made dear.
Result<PlanResult> Planner::Memory::plan_crops(const PlanRequest& request,
                                               const PlannerOptions& options, Rng& rng,
                                               const StageClock& clock) {
  StageTimer whole(clock);
  StageTimer stage(clock);
  bool ready = guide && world == request.world;
  if (ready) ready = guide->move_ends(request.start, request.goal).has_value();
  if (!ready) {
    guide.reset();
    world = request.world;
    auto made =
        CropsGuide::make(world, request.start, request.goal, options.risk, options.crops, rng);
    if (!made) return tl::unexpected(made.error());
    guide.emplace(*std::move(made));
  }
  PlanResult result;
  result.roadmap = guide->roadmap();
  result.stats.roadmap_ms = stage.lap_ms();
  return plan_of_routes(guide->routes(), guide->routes(), request, options.speed_mps,
                        std::move(result), whole);
}

Planner::Planner(const PlannerOptions& options)
    : options_(options), memory_(std::make_unique<Memory>()) {}
Planner::~Planner() = default;
Planner::Planner(Planner&&) noexcept = default;
Planner& Planner::operator=(Planner&&) noexcept = default;

Result<PlanResult> Planner::plan(const PlanRequest& request, Rng& rng, const StageClock& clock) {
  switch (options_.method) {
    case Method::kSwarmPrm:
      return plan_swarmprm(request, options_, rng, clock);
    case Method::kCrops:
      return memory_->plan_crops(request, options_, rng, clock);
  }
  SWARM_ASSERT(false);
}

void Planner::set_risk(const RiskLimit& risk) {
  if (risk.alpha == options_.risk.alpha && risk.delta_m == options_.risk.delta_m) return;
  options_.risk = risk;
  memory_->guide.reset();
}

bool Planner::avoid(const Vec2& stuck_at_m) {
  if (!memory_->guide) return false;
  const std::vector<Route>& routes = memory_->guide->routes();
  double nearest_m = std::numeric_limits<double>::infinity();
  std::optional<std::size_t> nearest;
  for (std::size_t r = 0; r < routes.size(); ++r) {
    for (const Gaussian& g : routes[r].waypoints) {
      const double distance_m = (g.mean_m() - stuck_at_m).norm();
      if (distance_m >= nearest_m) continue;
      nearest_m = distance_m;
      nearest = r;
    }
  }
  return nearest && memory_->guide->reweight(*nearest, stuck_at_m);
}

PlannerOptions planner_options(const PlannerSpec& spec) {
  const auto named = std::find_if(kMethods.begin(), kMethods.end(),
                                  [&](const auto& m) { return m.first == spec.method; });
  SWARM_ASSERT(named != kMethods.end());
  return {.method = named->second,
          .samples = spec.samples,
          .connection_radius_m = spec.connection_radius_m,
          .risk = {.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m},
          .sampler = {.kind = spec.sampler == "uniform" ? SamplerKind::kUniform : SamplerKind::kFit,
                      .sigma_min_m = spec.sigma_min_m,
                      .sigma_max_m = spec.sigma_max_m,
                      .rho_max = spec.rho_max,
                      .bridge_share = spec.bridge_share,
                      .bridge_sigma_m = spec.bridge_sigma_m},
          .shortcuts = spec.shortcuts,
          .speed_mps = spec.speed_mps,
          .crops = {.samples = spec.samples,
                    .connection_radius_m = spec.connection_radius_m,
                    .clearance_min_m = spec.crops_clearance_m,
                    .clearance_power = spec.crops_power,
                    .goal_radius_m = spec.crops_goal_radius_m}};
}

Result<PlanResult> plan(const PlanRequest& request, const PlannerOptions& options, Rng& rng,
                        const StageClock& clock) {
  return Planner(options).plan(request, rng, clock);
}

double planned_max_cvar_m(const FlowPlan& plan, const World& world, double alpha) {
  const double k = cvar_coefficient(alpha);
  double worst_m = -std::numeric_limits<double>::infinity();
  for (const PlanNode& node : plan.nodes()) {
    worst_m = std::max(worst_m, max_cvar_m(node.gaussian, world, k));
  }
  for (const PlanLeg& leg : plan.legs()) {
    const Geodesic geodesic(plan.nodes()[leg.from].gaussian, plan.nodes()[leg.to].gaussian);
    for (int i = 1; i < kFineGrid; ++i) {
      const Gaussian g = geodesic.at(static_cast<double>(i) / kFineGrid);
      worst_m = std::max(worst_m, max_cvar_m(g, world, k));
    }
  }
  return worst_m;
}

double planned_obstacle_share(const FlowPlan& plan, const World& world, std::size_t samples,
                              Rng& rng) {
  constexpr std::size_t kTimes = 100;
  const std::size_t points = std::max<std::size_t>(1, samples / kTimes);
  double worst = 0.0;
  for (std::size_t i = 0; i < kTimes; ++i) {
    const double share = static_cast<double>(i) / (kTimes - 1);
    const Mixture mixture = plan.mixture_at(share * plan.duration());
    std::size_t inside = 0;
    for (std::size_t p = 0; p < points; ++p) {
      const std::size_t component =
          mixture.component_at((static_cast<double>(p) + 0.5) / static_cast<double>(points));
      const Gaussian& g = mixture.components()[component].gaussian;
      const double u = standard_normal(rng);
      const Vec2 z(u, standard_normal(rng));
      inside += world.is_clear(g.mean_m() + cholesky_lower(g.covariance_m2()) * z, 0.0) ? 0U : 1U;
    }
    worst = std::max(worst, static_cast<double>(inside) / static_cast<double>(points));
  }
  return worst;
}

}  // namespace swarm::planner
