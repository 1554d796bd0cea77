// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/merge_routes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "planner_service/flow/pace.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// Differences of times below this are rounding.
constexpr double kLater_s = 1e-9;

// The parameters of a Gaussian, compared bit for bit.
using Key = std::array<double, 5>;

Key key_of(const Gaussian& g) {
  const Mat2& s = g.covariance_m2();
  return {g.mean_m().x(), g.mean_m().y(), s(0, 0), s(0, 1), s(1, 1)};
}

// The waypoints of all routes as nodes of a graph: starts, goals, then those in between, which may
// be made one.
class MergedGraph {
 public:
  MergedGraph(std::span<const Route> routes, std::size_t starts, std::size_t goals,
              const LegSpeed& speed)
      : terminals_(static_cast<std::uint32_t>(starts + goals)) {
    std::uint32_t next = terminals_;
    for (const Route& route : routes) {
      SWARM_ASSERT(route.waypoints.size() >= 2 && route.from < starts && route.to < goals);
      auto previous = static_cast<std::uint32_t>(route.from);
      for (std::size_t i = 1; i < route.waypoints.size(); ++i) {
        const bool is_last = i + 1 == route.waypoints.size();
        const std::uint32_t node = is_last ? static_cast<std::uint32_t>(starts + route.to) : next++;
        legs_.push_back({previous, node, route_leg_duration_s(route.waypoints, i, speed)});
        masses_.push_back(route.mass);
        previous = node;
      }
    }
    merged_.resize(next);
    std::iota(merged_.begin(), merged_.end(), 0U);
    const auto earliest_s = earliest_times_s(next, legs_);
    SWARM_ASSERT(earliest_s.has_value());
    due_s_.assign(earliest_s->begin(), earliest_s->begin() + terminals_);
  }

  std::size_t size() const { return merged_.size(); }
  std::uint32_t terminals() const { return terminals_; }
  std::uint32_t representative(std::uint32_t node) const { return merged_[node]; }

  // Makes two nodes one unless that closes a cycle or delays a goal. Tested by computing all
  // earliest times anew, O(legs), which bounds the whole by waypoints².
  void try_merge(std::uint32_t a, std::uint32_t b) {
    if (merged_[a] == merged_[b]) return;
    std::vector<std::uint32_t> kept = merged_;
    const auto [low, high] = std::minmax(merged_[a], merged_[b]);
    std::replace(merged_.begin(), merged_.end(), std::uint32_t{high}, std::uint32_t{low});
    if (!is_on_time()) merged_ = std::move(kept);
  }

  // Legs between representatives, parallel ones once, and their masses.
  std::pair<std::vector<PacedLeg>, std::vector<double>> merged_legs() const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<double, double>> legs;
    for (std::size_t l = 0; l < legs_.size(); ++l) {
      auto& [least_s, mass] = legs[{merged_[legs_[l].from], merged_[legs_[l].to]}];
      least_s = std::max(least_s, legs_[l].least_s);
      mass += masses_[l];
    }
    std::pair<std::vector<PacedLeg>, std::vector<double>> out;
    for (const auto& [ends, leg] : legs) {
      out.first.push_back({ends.first, ends.second, leg.first});
      out.second.push_back(leg.second);
    }
    return out;
  }

 private:
  // Whether the merged legs have no cycle and reach each terminal no later than without merging.
  bool is_on_time() const {
    const auto times_s = earliest_times_s(size(), merged_legs().first);
    if (!times_s) return false;
    for (std::size_t v = 0; v < terminals_; ++v) {
      if ((*times_s)[v] > due_s_[v] + kLater_s) return false;
    }
    return true;
  }

  std::uint32_t terminals_;
  std::vector<PacedLeg> legs_;
  std::vector<double> masses_;         // of the legs
  std::vector<std::uint32_t> merged_;  // representative of each node, the first of its group
  std::vector<double> due_s_;          // of starts and goals, without merging
};

}  // namespace

// Merges node by node, then paces the merged legs, then builds a plan of the representatives. The
// node numbering is that of MergedGraph: starts, goals, then inner waypoints route by route.
Result<FlowPlan> build_merged_plan(std::span<const Route> routes, std::size_t starts,
                                   std::size_t goals, const LegSpeed& speed) {
  SWARM_ASSERT(speed.means_mps > 0.0 && speed.robots_mps > 0.0);
  MergedGraph graph(routes, starts, goals, speed);
  std::vector<PlanNode> all(graph.size());
  std::map<Key, std::vector<std::uint32_t>> same;
  std::uint32_t next = graph.terminals();
  for (const Route& route : routes) {
    all[route.from].gaussian = route.waypoints.front();
    all[starts + route.to].gaussian = route.waypoints.back();
    for (std::size_t i = 1; i + 1 < route.waypoints.size(); ++i, ++next) {
      all[next].gaussian = route.waypoints[i];
      same[key_of(route.waypoints[i])].push_back(next);
    }
  }
  // In the order of the routes, so that the result depends on nothing else.
  for (std::uint32_t v = graph.terminals(); v < all.size(); ++v) {
    for (const std::uint32_t earlier : same[key_of(all[v].gaussian)]) {
      if (earlier >= v || graph.representative(v) != v) break;
      graph.try_merge(earlier, v);
    }
  }

  const auto [legs, masses] = graph.merged_legs();
  const auto earliest_s = earliest_times_s(all.size(), legs);
  SWARM_ASSERT(earliest_s.has_value());
  const std::vector<double> times_s = paced_times_s(*earliest_s, legs);
  std::vector<std::uint32_t> index(all.size(), 0);
  std::vector<PlanNode> nodes;
  for (std::uint32_t v = 0; v < all.size(); ++v) {
    if (graph.representative(v) != v) continue;
    index[v] = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back({all[v].gaussian, MissionTime(times_s[v]), 0.0});
  }
  std::vector<PlanLeg> plan_legs;
  for (std::size_t l = 0; l < legs.size(); ++l) {
    plan_legs.push_back({index[legs[l].from], index[legs[l].to], masses[l]});
    nodes[index[legs[l].to]].mass += masses[l];
    if (legs[l].from < starts) nodes[index[legs[l].from]].mass += masses[l];
  }
  return FlowPlan::make(std::move(nodes), std::move(plan_legs));
}

}  // namespace swarm::planner
