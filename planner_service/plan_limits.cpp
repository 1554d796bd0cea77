// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/plan_limits.hpp"

#include <fmt/format.h>

namespace swarm::planner {
namespace {

constexpr double kStep_s = 2.0;  // a mean moves 2.5 m, about a disc's radius

bool is_tracked(Method method) { return method == Method::kSwarmPrm || method == Method::kRover; }

}  // namespace

DensityPeak densest_disc_of(const FlowPlan& plan, double robots) {
  return densest_disc(plan, robots, kDisc_m, kStep_s);
}

std::string infeasible_density(const DensityPeak& densest, const SwarmLimits& limits) {
  return fmt::format(
      "planned density infeasible: {:.1f} robots/m2 at ({:.1f}, {:.1f}) m, t = {:.0f} s; at most "
      "{:.1f} fit",
      densest.per_m2, densest.at_m.x(), densest.at_m.y(), densest.time.count(),
      limits.packing_per_m2);
}

void check_limits(PlanResult& result, const PlannerOptions& options) {
  const SwarmLimits& limits = options.limits;
  if (limits.packing_per_m2 <= 0.0 || !is_tracked(options.method)) return;
  const double cap_per_m2 = result.stats.cap_per_m2;
  // No disc is denser than the cap that a timed plan keeps everywhere.
  if (cap_per_m2 <= 0.0 || cap_per_m2 > limits.packing_per_m2 || !options.density_is_timed) {
    result.stats.densest = densest_disc_of(result.plan, options.density.robots);
    if (result.stats.densest.per_m2 > limits.packing_per_m2) {
      result.warnings.push_back(
          {"density-infeasible", infeasible_density(result.stats.densest, limits)});
    }
  }
  if (options.speed_mps > limits.plan_speed_mps) {
    result.warnings.push_back(
        {"speed-infeasible",
         fmt::format("planned speed infeasible: {:.2f} m/s; the slowest robots follow {:.2f} m/s",
                     options.speed_mps, limits.plan_speed_mps)});
  }
}

}  // namespace swarm::planner
