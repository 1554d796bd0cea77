// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/planner.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "planner_service/mpc/flow_groups.hpp"
#include "planner_service/plan_limits.hpp"
#include "planner_service/plan_routes.hpp"
#include "planner_service/roadmap/live_roadmap.hpp"
#include "planner_service/stage_timer.hpp"
#include "planner_service/swarmprm.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

constexpr std::array<std::pair<std::string_view, Method>, 4> kMethods{
    {{"swarmprm", Method::kSwarmPrm},
     {"rover", Method::kRover},
     {"crops", Method::kCrops},
     {"adoc", Method::kAdoc}}};

SamplerKind sampler_named(std::string_view word) {
  if (word == "uniform") return SamplerKind::kUniform;
  return word == "halton" ? SamplerKind::kHalton : SamplerKind::kFit;
}

/// But for their weights, which may differ from one plan to the next.
bool same_shapes(const Mixture& a, const Mixture& b) {
  return std::equal(a.components().begin(), a.components().end(), b.components().begin(),
                    b.components().end(), [](const auto& l, const auto& r) {
                      return l.gaussian.mean_m() == r.gaussian.mean_m() &&
                             l.gaussian.covariance_m2() == r.gaussian.covariance_m2();
                    });
}

Result<PlanResult> plan_adoc(const PlanRequest& request, const PlannerOptions& options,
                             const StageClock& clock) {
  StageTimer whole(clock);
  StageTimer stage(clock);
  const auto routes = adoc_routes(request.world, request.start, request.goal, options.adoc);
  if (!routes) return tl::unexpected(routes.error());
  PlanResult result;
  result.stats.search_ms = stage.lap_ms();
  return plan_of_routes(*routes, *routes, request, leg_speed(options), std::move(result), whole);
}

}  // namespace

/// What the methods keep; guide and rover refer to `world`.
struct Planner::Memory {
  std::optional<LiveRoadmap> live;
  World world;
  Mixture goal;  // of the rover
  std::optional<CropsGuide> guide;
  std::optional<Rover> rover;

  Result<PlanResult> plan(const PlanRequest& request, const PlannerOptions& options, Rng& rng,
                          const StageClock& clock);
  Result<PlanResult> plan_swarmprm(const PlanRequest& request, const PlannerOptions& options,
                                   Rng& rng, const StageClock& clock);
  Result<Rover*> rover_for(const World& now, const Mixture& to, const PlannerOptions& options);
  Result<PlanResult> plan_rover(const PlanRequest& request, const PlannerOptions& options,
                                const StageClock& clock);
  Result<PlanResult> plan_crops(const PlanRequest& request, const PlannerOptions& options, Rng& rng,
                                const StageClock& clock);
};

Result<PlanResult> Planner::Memory::plan_swarmprm(const PlanRequest& request,
                                                  const PlannerOptions& options, Rng& rng,
                                                  const StageClock& clock) {
  StageTimer whole(clock);
  StageTimer stage(clock);
  if (auto checked = check_endpoints(request, options.risk); !checked) {
    return tl::unexpected(checked.error());
  }
  if (live) {
    live->update(request.world, terminals_of(request), rng);
  } else {
    const LiveRoadmapOptions wanted{.samples = options.samples,
                                    .connection_radius_m = options.connection_radius_m,
                                    .risk = options.risk,
                                    .sampler = options.sampler};
    live.emplace(request.world, terminals_of(request), wanted, rng);
  }
  return plan_on_roadmap(live->roadmap(), request, options, rng, stage, whole);
}

Result<Rover*> Planner::Memory::rover_for(const World& now, const Mixture& to,
                                          const PlannerOptions& options) {
  if (!rover || !(world == now) || !same_shapes(goal, to)) {
    rover.reset();
    world = now;
    goal = to;
    auto made = Rover::make(world, goal, options.rover);
    if (!made) return tl::unexpected(made.error());
    rover.emplace(*std::move(made));
  }
  return &*rover;
}

Result<PlanResult> Planner::Memory::plan_rover(const PlanRequest& request,
                                               const PlannerOptions& options,
                                               const StageClock& clock) {
  StageTimer whole(clock);
  StageTimer stage(clock);
  auto ready = rover_for(request.world, request.goal, options);
  if (!ready) return tl::unexpected(ready.error());
  PlanResult result;
  result.stats.roadmap_ms = stage.lap_ms();
  auto mission = (*ready)->plan(request.start, request.goal);
  if (!mission) return tl::unexpected(mission.error());
  result.stats.transport_ms = stage.lap_ms();
  result.excess =
      excess_of(mission->plan, request.world, options.risk, options.rover.graph.checks_between);
  return plan_of_flow(std::move(mission->plan), std::move(result), whole);
}

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
  return plan_of_routes(guide->routes(), guide->routes(), request, leg_speed(options),
                        std::move(result), whole);
}

Planner::Planner(const PlannerOptions& options)
    : options_(options), memory_(std::make_unique<Memory>()) {}
Planner::~Planner() = default;
Planner::Planner(Planner&&) noexcept = default;
Planner& Planner::operator=(Planner&&) noexcept = default;

Result<PlanResult> Planner::Memory::plan(const PlanRequest& request, const PlannerOptions& options,
                                         Rng& rng, const StageClock& clock) {
  switch (options.method) {
    case Method::kSwarmPrm:
      return plan_swarmprm(request, options, rng, clock);
    case Method::kRover:
      return plan_rover(request, options, clock);
    case Method::kAdoc:
      return plan_adoc(request, options, clock);
    case Method::kCrops:
      return plan_crops(request, options, rng, clock);
  }
  SWARM_ASSERT(false);
}

Result<PlanResult> Planner::plan(const PlanRequest& request, Rng& rng, const StageClock& clock) {
  auto result = memory_->plan(request, options_, rng, clock);
  if (result) check_limits(*result, options_);
  return result;
}

void Planner::set_risk(const RiskLimit& risk) {
  if (risk.alpha == options_.risk.alpha && risk.delta_m == options_.risk.delta_m) return;
  options_.risk = risk;
  options_.rover.graph.risk = risk;
  *memory_ = Memory{};
}

Result<std::vector<RobotGroup>> Planner::measure(const World& world, const Mixture& goal,
                                                 std::span<const HeardRobot> robots) {
  if (options_.method != Method::kRover) {
    return group_robots(robots, world, goal, options_.risk, {});
  }
  // A swarm in flight may break (11g) where it is: then the way out of that comes first.
  if (!options_.rover.mpc.soften) {
    options_.rover.mpc.soften = true;
    memory_->rover.reset();
  }
  const auto ready = memory_->rover_for(world, goal, options_);
  if (!ready) return tl::unexpected(ready.error());
  return group_by_flow(robots, (*ready)->graph(), goal, {});
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

PlannerOptions planner_options(const PlannerSpec& spec, std::uint32_t robots) {
  const auto named = std::find_if(kMethods.begin(), kMethods.end(),
                                  [&](const auto& m) { return m.first == spec.method; });
  SWARM_ASSERT(named != kMethods.end());
  const CollocationOptions collocation{.spacing_m = spec.collocation_spacing_m,
                                       .sigma_m = spec.collocation_sigma_m};
  return {.method = named->second,
          .samples = spec.samples,
          .connection_radius_m = spec.connection_radius_m,
          .risk = {.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m},
          .sampler = {.kind = sampler_named(spec.sampler),
                      .sigma_min_m = spec.sigma_min_m,
                      .sigma_max_m = spec.sigma_max_m,
                      .rho_max = spec.rho_max,
                      .bridge_share = spec.bridge_share,
                      .bridge_sigma_m = spec.bridge_sigma_m},
          .shortcuts = spec.shortcuts,
          .speed_mps = spec.speed_mps,
          .density = {.max_per_m2 = spec.density_cap_per_m2.value_or(0.0),
                      .robots = static_cast<double>(robots)},
          .density_is_timed = spec.density_cap == "timed",
          .rover = {.graph = {.collocation = collocation,
                              .transport_radius_m = spec.transport_radius_m,
                              .risk = {.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m}},
                    .mpc = {.costs = {.horizon = spec.horizon},
                            .density_cap_per_m2 = spec.density_cap_per_m2.value_or(0.0),
                            .robots = static_cast<double>(robots)},
                    .speed_mps = spec.speed_mps},
          .adoc = {.collocation = collocation,
                   .transport_radius_m = spec.transport_radius_m,
                   .penalty = spec.adoc_penalty},
          .crops = {.samples = spec.samples,
                    .connection_radius_m = spec.connection_radius_m,
                    .clearance_min_m = spec.crops_clearance_m,
                    .clearance_power = spec.crops_power,
                    .goal_radius_m = spec.crops_goal_radius_m}};
}

PlannerOptions planner_options(const Mission& mission) {
  PlannerOptions options = planner_options(mission.planner, mission.robots.count);
  options.limits = swarm_limits(mission.robots, mission.safety, mission.control);
  if (options.method == Method::kSwarmPrm && !mission.planner.density_cap_per_m2) {
    options.cap_is_automatic = true;
    options.speed_mps = std::min(options.speed_mps, options.limits.plan_speed_mps);
  }
  return options;
}

Result<PlanResult> plan(const PlanRequest& request, const PlannerOptions& options, Rng& rng,
                        const StageClock& clock) {
  if (options.method != Method::kSwarmPrm) return Planner(options).plan(request, rng, clock);
  // A roadmap that need not be kept costs less.
  StageTimer whole(clock);
  StageTimer stage(clock);
  if (auto checked = check_endpoints(request, options.risk); !checked) {
    return tl::unexpected(checked.error());
  }
  auto result =
      plan_on_roadmap(make_roadmap(request, options, rng), request, options, rng, stage, whole);
  if (result) check_limits(*result, options);
  return result;
}

}  // namespace swarm::planner
