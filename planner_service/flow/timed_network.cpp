// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/timed_network.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <span>
#include <utility>

#include "planner_service/flow/min_cost_flow.hpp"
#include "planner_service/flow/route.hpp"
#include "planner_service/flow/shortest_routes.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// A leg that exceeds whole steps by less than this share of a step is not rounded up.
constexpr double kWholeStep = 1e-9;
// Rounding up makes a leg half a step later than it could be; a third instead of half the median
// leg makes paths half a percent shorter and takes twice as long to solve.
constexpr double kStepsPerLeg = 2.0;

// A directed edge of the roadmap on a near-shortest path.
struct Leg {
  std::uint32_t from;
  std::uint32_t to;
  double length_m;
  double duration_s;
};

// Lengths of the shortest paths through a node or leg, from every start to every goal: one search
// from each of them.
class Paths {
 public:
  Paths(const Roadmap& roadmap, std::size_t starts, std::size_t goals, double detour)
      : starts_(starts), detour_(detour) {
    constexpr std::span<const std::uint32_t> kEverywhere;
    for (std::uint32_t c = 0; c < starts + goals; ++c) from_.emplace_back(roadmap, c, kEverywhere);
  }

  bool are_near_shortest(std::uint32_t u, std::uint32_t v, double length_m) const {
    for (std::size_t i = 0; i < starts_; ++i) {
      for (std::size_t j = starts_; j < from_.size(); ++j) {
        const double shortest_m = from_[i].length_m(static_cast<std::uint32_t>(j));
        // Edges are undirected, so that the length from the goal is the length to the goal.
        const double path_m = from_[i].length_m(u) + length_m + from_[j].length_m(v);
        if (std::isfinite(path_m) && path_m <= detour_ * shortest_m) return true;
      }
    }
    return false;
  }

 private:
  std::size_t starts_;
  double detour_;
  std::vector<ShortestRoutes> from_;
};

// The directed edges that lie on a path no longer than detour times the shortest between some start
// and goal, proven to the tolerance of a plan. An edge is proven once for both directions. All
// other edges are left out: the unrolled network is many times the roadmap.
std::vector<Leg> near_shortest(const Roadmap& roadmap, std::size_t starts, std::size_t goals,
                               const TimedNetworkOptions& options, EdgeChecker& checker) {
  const Paths paths(roadmap, starts, goals, options.detour);
  std::vector<Leg> legs;
  for (std::uint32_t u = 0; u < roadmap.nodes.size(); ++u) {
    for (const Roadmap::Arc& arc : roadmap.arcs_of(u)) {
      if (arc.to < u || !std::isfinite(arc.length_m)) continue;
      const bool there = paths.are_near_shortest(u, arc.to, arc.length_m);
      const bool back = paths.are_near_shortest(arc.to, u, arc.length_m);
      if (!there && !back) continue;
      const Gaussian& a = roadmap.nodes[u];
      const Gaussian& b = roadmap.nodes[arc.to];
      if (!checker.is_free(a, b, kPlanTolerance_m)) continue;
      const bool is_end = u < starts + goals || arc.to < starts + goals;
      const double there_s = is_end ? end_leg_duration_s(a, b, options.speed)
                                    : leg_duration_s(a, b, options.speed.means_mps);
      const double back_s = is_end ? end_leg_duration_s(b, a, options.speed) : there_s;
      if (there) legs.push_back({u, arc.to, arc.length_m, there_s});
      if (back) legs.push_back({arc.to, u, arc.length_m, back_s});
    }
  }
  return legs;
}

// The step of the grid is a share of the median: a few very short legs do not make it fine.
double median_duration_s(const std::vector<Leg>& legs) {
  std::vector<double> durations_s;
  for (const Leg& leg : legs) durations_s.push_back(leg.duration_s);
  if (durations_s.empty()) return 1.0;
  const auto middle = durations_s.begin() + static_cast<std::ptrdiff_t>(durations_s.size() / 2);
  std::nth_element(durations_s.begin(), middle, durations_s.end());
  return *middle;
}

}  // namespace

struct TimedNetwork::Unrolled {
  std::vector<double> balance;
  std::vector<FlowArc> arcs;
  std::vector<TimedMove> moves;  // of each arc; from_step = to_step within a node
};

// Durations are rounded up to whole steps, at least one, so that no leg is faster than the speed.
TimedNetwork::TimedNetwork(const Roadmap& roadmap, std::size_t starts, std::size_t goals,
                           const TimedNetworkOptions& options, EdgeChecker& checker)
    : starts_(starts), goals_(goals) {
  SWARM_ASSERT(options.step_s >= 0.0 && options.speed.means_mps > 0.0 &&
               options.delay_cost_mps >= 0.0);
  const std::vector<Leg> legs = near_shortest(roadmap, starts, goals, options, checker);
  step_s_ = options.step_s > 0.0 ? options.step_s : median_duration_s(legs) / kStepsPerLeg;
  step_cost_m_ = options.delay_cost_mps * step_s_;
  arcs_.resize(roadmap.nodes.size());
  Arcs back(roadmap.nodes.size());
  for (const Leg& leg : legs) {
    const double steps = std::max(1.0, std::ceil(leg.duration_s / step_s_ - kWholeStep));
    arcs_[leg.from].push_back({leg.to, static_cast<std::uint32_t>(steps), leg.length_m});
    back[leg.to].push_back({leg.from, static_cast<std::uint32_t>(steps), leg.length_m});
  }
  earliest_ = steps_from(arcs_, 0, starts);
  left_ = steps_from(back, starts, goals);
}

// Dijkstra in whole steps from several sources at once: the earliest step at every node.
std::vector<std::uint32_t> TimedNetwork::steps_from(const Arcs& arcs, std::size_t first,
                                                    std::size_t count) {
  using Entry = std::pair<std::uint32_t, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  std::vector<std::uint32_t> steps(arcs.size(), kNever);
  for (std::size_t v = first; v < first + count; ++v) {
    steps[v] = 0;
    open.emplace(0U, static_cast<std::uint32_t>(v));
  }
  while (!open.empty()) {
    const auto [step, v] = open.top();
    open.pop();
    if (step > steps[v]) continue;
    for (const Arc& arc : arcs[v]) {
      if (step + arc.steps >= steps[arc.to]) continue;
      steps[arc.to] = step + arc.steps;
      open.emplace(step + arc.steps, arc.to);
    }
  }
  return steps;
}

// The longest of the fastest paths: from a start to its nearest goal, and to a goal from its
// nearest start.
std::optional<std::uint32_t> TimedNetwork::free_flow_steps() const {
  std::uint32_t longest = 0;
  for (std::size_t v = 0; v < starts_ + goals_; ++v) {
    const std::uint32_t steps = v < starts_ ? left_[v] : earliest_[v];
    if (steps == kNever) return std::nullopt;
    longest = std::max(longest, steps);
  }
  return longest;
}

// Each copy has an arc through it, an arc of waiting and an arc for each leg.
std::size_t TimedNetwork::arc_count(std::uint32_t horizon) const {
  std::size_t count = 0;
  for (std::size_t v = 0; v < arcs_.size(); ++v) {
    count += copies(v, horizon) * (2 + arcs_[v].size());
  }
  return count;
}

// Builds the time-expanded network. A copy of node v exists for steps earliest[v] to horizon −
// left[v]:
// at others no mass could be there that also arrives in time. The arc between the two halves of a
// copy carries the capacity. Supplies enter at step 0, demands leave at the horizon; mass at a goal
// waits free of charge.
TimedNetwork::Unrolled TimedNetwork::unrolled(std::uint32_t horizon,
                                              const TimedDemand& demand) const {
  SWARM_ASSERT(demand.supplies.size() == starts_ && demand.demands.size() == goals_ &&
               demand.capacities.size() == arcs_.size());
  // Copies of node v are numbered from first[v], each split into where mass comes in and leaves.
  std::vector<std::uint32_t> first;
  std::uint32_t all = 0;
  for (std::size_t v = 0; v < arcs_.size(); ++v) {
    first.push_back(all);
    all += copies(v, horizon);
  }
  const auto in_of = [&](std::size_t v, std::uint32_t step) {
    return 2 * (first[v] + step - earliest_[v]);
  };

  Unrolled net;
  net.balance.assign(2 * std::size_t{all}, 0.0);
  for (std::size_t v = 0; v < starts_ + goals_; ++v) {
    SWARM_ASSERT(is_in_time(v, v < starts_ ? 0 : horizon, horizon));
    if (v < starts_) {
      net.balance[in_of(v, 0)] = demand.supplies[v];
    } else {
      net.balance[in_of(v, horizon) + 1] = -demand.demands[v - starts_];
    }
  }
  net.arcs.reserve(arc_count(horizon));
  net.moves.reserve(arc_count(horizon));
  for (std::uint32_t v = 0; v < arcs_.size(); ++v) {
    for (std::uint32_t step = earliest_[v]; is_in_time(v, step, horizon); ++step) {
      const std::uint32_t in = in_of(v, step);
      net.arcs.push_back({in, in + 1, 0.0, demand.capacities[v]});
      net.moves.push_back({v, step, v, step, 0.0});
      if (is_in_time(v, step + 1, horizon)) {
        net.arcs.push_back({.from = in + 1, .to = in + 2, .cost = is_goal(v) ? 0.0 : step_cost_m_});
        net.moves.push_back({v, step, v, step + 1, 0.0});
      }
      for (const Arc& arc : arcs_[v]) {
        const std::uint32_t then = step + arc.steps;
        if (!is_in_time(arc.to, then, horizon)) continue;
        net.arcs.push_back({.from = in + 1,
                            .to = in_of(arc.to, then),
                            .cost = arc.length_m + arc.steps * step_cost_m_});
        net.moves.push_back({v, step, arc.to, then, 0.0});
      }
    }
  }
  return net;
}

// Network simplex on the unrolled network. Arcs within a copy are not moves and are left out.
std::optional<std::vector<TimedMove>> TimedNetwork::solve(std::uint32_t horizon,
                                                          const TimedDemand& demand) const {
  const Unrolled net = unrolled(horizon, demand);
  const auto flow = min_cost_flow(net.balance, net.arcs);
  if (!flow) return std::nullopt;
  std::vector<TimedMove> used;
  for (std::size_t a = 0; a < net.arcs.size(); ++a) {
    if ((*flow)[a] == 0.0 || net.moves[a].from_step == net.moves[a].to_step) continue;
    used.push_back(net.moves[a]);
    used.back().mass = (*flow)[a];
  }
  return used;
}

double TimedNetwork::mass_that_fits(std::uint32_t horizon, const TimedDemand& demand) const {
  // Every supply may bypass the network at cost 1, and nothing else costs: the optimum bypasses as
  // little as possible, which is the mass that does not fit (a maximum flow).
  Unrolled net = unrolled(horizon, demand);
  for (FlowArc& arc : net.arcs) arc.cost = 0.0;
  const std::size_t bypasses = net.arcs.size();
  const auto hub = static_cast<std::uint32_t>(net.balance.size());
  for (std::uint32_t node = 0; node < hub; ++node) {
    if (net.balance[node] > 0.0) net.arcs.push_back({.from = node, .to = hub, .cost = 1.0});
    if (net.balance[node] < 0.0) net.arcs.push_back({.from = hub, .to = node});
  }
  net.balance.push_back(0.0);
  const auto flow = min_cost_flow(net.balance, net.arcs);
  SWARM_ASSERT(flow.has_value());
  double fits = 1.0;
  for (std::size_t a = bypasses; a < net.arcs.size(); ++a) fits -= net.arcs[a].cost * (*flow)[a];
  return fits;
}

}  // namespace swarm::planner
