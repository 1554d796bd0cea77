// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "planner_service/flow/route.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "swarmflow/planning/roadmap.hpp"

namespace swarm::planner {

/// Time grid and costs of a TimedNetwork.
struct TimedNetworkOptions {
  LegSpeed speed{};           ///< ends are legs at a start or goal component
  double step_s = 0.0;        ///< the grid of times; 0 for half of the median leg
  double detour = 1.05;       ///< legs on no path within this factor of the shortest are left out
  double delay_cost_mps = 0;  ///< cost of a second of travel or waiting, besides the path length
};

/// Mass that moves (or waits, when `from` = `to`) between two nodes of the roadmap.
struct TimedMove {
  std::uint32_t from = 0;
  std::uint32_t from_step = 0;
  std::uint32_t to = 0;
  std::uint32_t to_step = 0;
  double mass = 0.0;
};

/// The transport a swarm has to carry out: masses of the start and goal components, each summing to
/// 1, and what every node of the roadmap may hold at a time.
struct TimedDemand {
  std::span<const double> supplies;
  std::span<const double> demands;
  std::span<const double> capacities;
};

/// The part of a roadmap that matters for one transport, unrolled over time: a copy of every node
/// for every step, arcs that take as many steps as the leg needs at the given speed (rounded up),
/// and arcs that wait for one. The mass at a node at a step, moving or waiting, is within its
/// capacity.
///
/// Left out: legs off the near-shortest paths, legs not proven to kPlanTolerance_m, and copies that
/// are too early to be reached or too late to reach a goal.
class TimedNetwork {
 public:
  /// Nodes 0 … starts − 1 of the roadmap are the start components, then come the goal components.
  TimedNetwork(const Roadmap& roadmap, std::size_t starts, std::size_t goals,
               const TimedNetworkOptions& options, EdgeChecker& checker);

  double step_s() const { return step_s_; }

  /// Steps until all mass has arrived if none has to wait; nothing when some component has no path.
  std::optional<std::uint32_t> free_flow_steps() const;

  /// Cheapest flow that has arrived after `horizon` steps. A move costs its W₂ length and the cost
  /// of its time, waiting the cost of time alone, waiting at a goal nothing. Nothing when no flow
  /// fits. Exactness as of min_cost_flow().
  std::optional<std::vector<TimedMove>> solve(std::uint32_t horizon,
                                              const TimedDemand& demand) const;

  /// Largest share of the swarm that can arrive within `horizon` steps.
  double mass_that_fits(std::uint32_t horizon, const TimedDemand& demand) const;

  /// Size of the network of a horizon, before it is built; an upper bound.
  std::size_t arc_count(std::uint32_t horizon) const;

 private:
  // A directed leg with its duration in whole steps.
  struct Arc {
    std::uint32_t to;
    std::uint32_t steps;
    double length_m;
  };
  struct Unrolled;
  using Arcs = std::vector<std::vector<Arc>>;  // of every node
  static constexpr std::uint32_t kNever = UINT32_MAX;

  static std::vector<std::uint32_t> steps_from(const Arcs& arcs, std::size_t first,
                                               std::size_t count);
  Unrolled unrolled(std::uint32_t horizon, const TimedDemand& demand) const;
  bool is_goal(std::size_t v) const { return v >= starts_ && v < starts_ + goals_; }
  bool is_in_time(std::size_t v, std::uint32_t step, std::uint32_t horizon) const {
    return copies(v, horizon) > 0 && step >= earliest_[v] && step + left_[v] <= horizon;
  }
  std::uint32_t copies(std::size_t v, std::uint32_t horizon) const {
    if (earliest_[v] == kNever || left_[v] == kNever) return 0;
    return earliest_[v] + left_[v] > horizon ? 0 : horizon - left_[v] - earliest_[v] + 1;
  }

  std::size_t starts_, goals_;
  double step_s_ = 0.0;
  double step_cost_m_ = 0.0;
  Arcs arcs_;
  std::vector<std::uint32_t> earliest_;  // steps from the nearest start
  std::vector<std::uint32_t> left_;      // steps to the nearest goal
};

}  // namespace swarm::planner
