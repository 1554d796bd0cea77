// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner_service/flow/density_parts.hpp"
#include "swarmflow/core/flow_plan.hpp"

namespace swarm::planner {

/// The density of a plan at sampled times while its Gaussians are moved: only the legs that change
/// are evaluated again. Times and masses are fixed, and with them the legs present at each time.
///
/// Memory: a part for each leg and sampled time of it.
class DensityGrid {
 public:
  DensityGrid(const FlowPlan& plan, double robots, double step_s);

  /// Takes over the Gaussians of the ends of `legs` from `nodes` if, climbed to from the mean of
  /// each of them at each of their times, the density of all stays within `limit_per_m2`;
  /// otherwise changes nothing. \pre the nodes are those of the plan but for their Gaussians
  bool try_change(const std::vector<PlanNode>& nodes, std::span<const std::uint32_t> legs,
                  double limit_per_m2);

 private:
  // A leg, or a source or sink at rest, with its Gaussian at each of its times.
  struct Leg {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    double robots = 0.0;
    std::uint32_t first = 0;  // of the times at which it is under way
    std::vector<DensityPart> parts;
  };
  std::vector<DensityPart> parts_of(const Leg& leg, const std::vector<PlanNode>& nodes) const;
  bool keeps(const Leg& leg, double limit_per_m2);

  std::vector<MissionTime> times_;
  std::vector<Leg> legs_;                          // then sinks, as legs from themselves
  std::vector<std::vector<std::uint32_t>> alive_;  // legs under way at each time
  std::vector<DensityPart> in_sight_;              // scratch
};

}  // namespace swarm::planner
