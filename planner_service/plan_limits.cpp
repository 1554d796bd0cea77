// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/plan_limits.hpp"

#include <fmt/format.h>

#include "planner_service/flow/plan_density.hpp"

namespace swarm::planner {

// The densest disc is the costly part; it is skipped where the cap of a timed plan bounds it.
void check_limits(PlanResult& result, const PlanningTraits& traits, const SwarmLimits& limits,
                  double robots) {
  if (limits.packing_per_m2 <= 0.0 || !traits.is_kept_in_time) return;
  const double cap_per_m2 = result.stats.cap_per_m2;
  // No disc is denser than the cap that a timed plan keeps everywhere.
  const bool is_bounded =
      result.stats.cap_is_timed && cap_per_m2 > 0.0 && cap_per_m2 <= limits.packing_per_m2;
  if (!is_bounded) {
    const DensityPeak densest = densest_disc_of(result.plan, robots, limits.length_scale);
    result.stats.densest = densest;
    if (densest.per_m2 > limits.packing_per_m2) {
      result.warnings.push_back(
          {"density-infeasible",
           fmt::format("planned density infeasible: {:.1f} robots/m2 at ({:.1f}, {:.1f}) m, t = "
                       "{:.0f} s; at most {:.1f} fit",
                       densest.per_m2, densest.at_m.x(), densest.at_m.y(), densest.time.count(),
                       limits.packing_per_m2)});
    }
  }
  if (traits.speed_mps > limits.plan_speed_mps) {
    result.warnings.push_back(
        {"speed-infeasible",
         fmt::format("planned speed infeasible: {:.2f} m/s; the slowest robots follow {:.2f} m/s",
                     traits.speed_mps, limits.plan_speed_mps)});
  }
}

}  // namespace swarm::planner
