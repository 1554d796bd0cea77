// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/world.hpp"

/// When the groups of a plan pass a passage: from the plan and the map alone, for reports and
/// tests.
namespace swarm::planner {

/// The shortest segment between two obstacles that do not touch.
struct Passage {
  Vec2 from_m = Vec2::Zero();
  Vec2 to_m = Vec2::Zero();
  double width_m() const { return (to_m - from_m).norm(); }
};

/// The narrowest passage between two convex parts of obstacles that means of the plan cross;
/// nothing where they cross none. Cost: parts² boxes, and legs · edges for those that are narrower
/// than the best so far.
std::optional<Passage> narrowest_passage(const FlowPlan& plan, const World& world);

/// Of the mass that starts in one component, as a plan's means move it. Behind a node where routes
/// meet it is mixed with the rest, as robots are.
struct GroupTimes {
  /// When the mass of a group passes an event.
  struct Span {
    MissionTime first{0};
    MissionTime half{0};  ///< when half of the mass is through
    MissionTime last{0};
  };
  double share = 0.0;  ///< of the swarm
  Span leaves, arrives;
  std::optional<Span> passes;       ///< the passage; nothing if it does not
  MissionTime waits_on_average{0};  ///< until it arrives, beyond its path at the given speed
};

/// One for each source of the plan. O(legs · sources).
std::vector<GroupTimes> group_times(const FlowPlan& plan, const std::optional<Passage>& passage,
                                    double speed_mps);

/// The passage and a line for each group, times in seconds.
std::string to_table(const std::vector<GroupTimes>& groups, const std::optional<Passage>& passage,
                     double robots);

}  // namespace swarm::planner
