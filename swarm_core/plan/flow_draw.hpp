// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "swarm_core/base/assert.hpp"
#include "swarmflow/core/flow_plan.hpp"

namespace swarm {

/// The draw at a split: the index whose interval of the cumulated masses contains `share` ∈ [0, 1),
/// which is then rescaled to that interval, ready for the next split. Robots and planner use the
/// same draw, so the planner knows the leg of every robot. \pre count > 0, masses positive
template <class MassOf>
std::size_t draw_by_share(std::size_t count, MassOf mass_of, double& share) {
  double total = 0.0;
  for (std::size_t i = 0; i < count; ++i) total += mass_of(i);
  double target = share * total;
  std::size_t chosen = 0;
  while (chosen + 1 < count && target >= mass_of(chosen)) target -= mass_of(chosen++);
  share = std::clamp(target / mass_of(chosen), 0.0, std::nextafter(1.0, 0.0));
  return chosen;
}

/// The source that a share of the whole swarm starts in, an index into FlowPlan::sources().
inline std::size_t draw_source(const FlowPlan& plan, double& share) {
  const auto& sources = plan.sources();
  return draw_by_share(
      sources.size(), [&](std::size_t i) { return plan.nodes()[sources[i]].mass; }, share);
}

/// The leg on which a share of a node's mass leaves it, an index into FlowPlan::legs(). \pre the
/// node is no sink
inline std::uint32_t draw_leg(const FlowPlan& plan, std::uint32_t node, double& share) {
  const auto out = plan.legs_out(node);
  return out[draw_by_share(
      out.size(), [&](std::size_t i) { return plan.legs()[out[i]].mass; }, share)];
}

/// Where a share of the mass of a source is in a flow at a time, and the sink at which it arrives.
struct FlowPosition {
  /// Value of `leg` when the mass has arrived.
  static constexpr std::uint32_t kAtSink = 0xFFFFFFFF;
  std::uint32_t leg = kAtSink;  ///< the leg it is on; before the source's time the first leg
  std::uint32_t sink = 0;       ///< index of the node
};

/// \pre `source` is an index into plan.sources()
inline FlowPosition position_in_flow(const FlowPlan& plan, std::size_t source, double share,
                                     MissionTime at) {
  FlowPosition place;
  std::uint32_t node = plan.sources()[source];
  while (!plan.legs_out(node).empty()) {
    const std::uint32_t leg = draw_leg(plan, node, share);
    node = plan.legs()[leg].to;
    if (place.leg == FlowPosition::kAtSink && at < plan.nodes()[node].time) place.leg = leg;
  }
  place.sink = node;
  return place;
}

}  // namespace swarm
