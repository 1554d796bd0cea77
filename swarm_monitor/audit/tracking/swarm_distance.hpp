// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "swarm_monitor/audit/tracking/plan_timeline.hpp"
#include "swarm_monitor/audit/tracking/sample_distance.hpp"

namespace swarm::monitor {

/// The swarm and χ(τ) at one moment.
struct SwarmDistance {
  double time_s = 0.0;
  double plan_time_s = 0.0;
  std::uint32_t plan_version = 0;
  double arrived_share = 0.0;
  Distance robots{};  ///< the living ones to a sample of χ(τ)
  /// The references that these robots logged, to a sample of χ(τ); every fourth moment, if at least
  /// nine in ten of them logged one.
  std::optional<Distance> references{};
};

/// W2 of the living robots to χ(τ) and its floor, at moments that ascend in time. Of more than
/// `most_robots` robots every n-th by id enters, which keeps the shares of the components, since
/// neighbouring ids take the same legs. The samples depend on the moment's number alone: the same
/// run gives the same numbers. Two and a quarter assignments per moment: 40 moments of 500 robots
/// take 1.4 s.
std::vector<SwarmDistance> swarm_distances(const RecordedRun& run,
                                           std::span<const PlanMoment> moments,
                                           std::size_t most_robots = 500);

/// Mean W2 and mean floor over moments; empty of none.
std::optional<Distance> mean_distance(std::span<const SwarmDistance> distances);

/// The same of the logged references, over the moments at which they were looked at.
std::optional<Distance> mean_reference_distance(std::span<const SwarmDistance> distances);

/// The same of the moments of one plan.
struct PlanDistance {
  std::uint32_t plan_version = 0;
  std::size_t moments = 0;
  Distance mean{};
};
std::vector<PlanDistance> distances_by_plan(std::span<const SwarmDistance> distances);

}  // namespace swarm::monitor
