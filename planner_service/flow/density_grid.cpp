// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/density_grid.hpp"

#include <algorithm>
#include <utility>

#include "planner_service/flow/plan_density.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {

// Evaluates each leg at all sampled times at which it is under way. Sources before their time and
// sinks from theirs on are legs from themselves to themselves.
DensityGrid::DensityGrid(const FlowPlan& plan, double robots, double step_s)
    : times_(density_times(plan, step_s)), alive_(times_.size()) {
  const std::vector<PlanNode>& nodes = plan.nodes();
  const auto index_of = [&](MissionTime t) {
    return static_cast<std::uint32_t>(std::lower_bound(times_.begin(), times_.end(), t) -
                                      times_.begin());
  };
  const auto add = [&](Leg leg, std::uint32_t end) {
    for (std::uint32_t k = leg.first; k < end; ++k) {
      alive_[k].push_back(static_cast<std::uint32_t>(legs_.size()));
    }
    legs_.push_back(std::move(leg));
    legs_.back().parts = parts_of(legs_.back(), nodes);
  };
  for (const PlanLeg& leg : plan.legs()) {
    add({leg.from, leg.to, leg.mass * robots, index_of(nodes[leg.from].time), {}},
        index_of(nodes[leg.to].time));
  }
  const auto end = static_cast<std::uint32_t>(times_.size());
  for (const std::uint32_t i : plan.sources()) {
    add({i, i, nodes[i].mass * robots, 0, {}}, index_of(nodes[i].time));
  }
  for (const std::uint32_t i : plan.sinks()) {
    add({i, i, nodes[i].mass * robots, index_of(nodes[i].time), {}}, end);
  }
}

// The Gaussians of a leg at its times. A source at rest gets one for every later time as well, of
// which only those before its departure are used.
std::vector<DensityPart> DensityGrid::parts_of(const Leg& leg,
                                               const std::vector<PlanNode>& nodes) const {
  std::vector<DensityPart> parts;
  const PlanNode& from = nodes[leg.from];
  const PlanNode& to = nodes[leg.to];
  if (leg.from == leg.to) {
    parts.assign(times_.size() - leg.first, DensityPart(from.gaussian, leg.robots));
    return parts;
  }
  const Geodesic geodesic(from.gaussian, to.gaussian);
  for (std::uint32_t k = leg.first; k < times_.size() && times_[k] < to.time; ++k) {
    const double share = (times_[k] - from.time) / (to.time - from.time);
    parts.emplace_back(geodesic.at(share), leg.robots);
  }
  return parts;
}

// Whether the density keeps the limit when climbed to from the mean of the changed leg at each of
// its times. Only parts in sight count. The density at the mean decides first: above the limit is a
// violation, far below it needs no climb.
bool DensityGrid::keeps(const Leg& changed, double limit_per_m2) {
  for (std::uint32_t at = 0; at < changed.parts.size(); ++at) {
    const std::uint32_t k = changed.first + at;
    const Vec2& start_m = changed.parts[at].mean_m();
    double density = 0.0;
    in_sight_.clear();
    for (const std::uint32_t l : alive_[k]) {
      const DensityPart& part = legs_[l].parts[k - legs_[l].first];
      if (!part.is_in_sight(start_m)) continue;
      in_sight_.push_back(part);
      density += part.density_at(start_m);
    }
    if (density > limit_per_m2) return false;
    if (density < kWorthClimbing * limit_per_m2) continue;
    const Vec2 top_m = climb(in_sight_, start_m);
    double highest = 0.0;
    for (const DensityPart& part : in_sight_) highest += part.density_at(top_m);
    if (highest > limit_per_m2) return false;
  }
  return true;
}

// Replaces the parts of all changed legs before any of them is tested, since they may overlap; puts
// all back when one fails.
bool DensityGrid::try_change(const std::vector<PlanNode>& nodes,
                             std::span<const std::uint32_t> legs, double limit_per_m2) {
  std::vector<std::vector<DensityPart>> before;
  for (const std::uint32_t l : legs) {
    before.push_back(std::exchange(legs_[l].parts, parts_of(legs_[l], nodes)));
  }
  const bool all_keep = std::all_of(legs.begin(), legs.end(),
                                    [&](std::uint32_t l) { return keeps(legs_[l], limit_per_m2); });
  if (all_keep) return true;
  for (std::size_t i = 0; i < legs.size(); ++i) legs_[legs[i]].parts = std::move(before[i]);
  return false;
}

}  // namespace swarm::planner
