// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/timed_plan.hpp"

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// Moves of less mass than this are rounding.
constexpr double kNothing = 1e-9;

// A node of the roadmap at a step.
struct Copy {
  std::uint32_t node = 0;
  std::uint32_t step = 0;
  auto operator<=>(const Copy&) const = default;
};

Copy from_of(const TimedMove& move) { return {move.from, move.from_step}; }
Copy to_of(const TimedMove& move) { return {move.to, move.to_step}; }
bool waits(const TimedMove& move) { return move.from == move.to; }

// Removes what rounding left: moves of negligible mass, and then moves that no longer begin at mass
// from a start (first pass, in order of time) or no longer lead to a goal (second pass, backwards).
void drop_negligible(std::vector<TimedMove>& moves, std::size_t starts, std::size_t goals) {
  std::erase_if(moves, [](const TimedMove& move) { return move.mass < kNothing; });
  std::sort(moves.begin(), moves.end(),
            [](const TimedMove& a, const TimedMove& b) { return from_of(a) < from_of(b); });
  std::stable_sort(moves.begin(), moves.end(), [](const TimedMove& a, const TimedMove& b) {
    return a.from_step < b.from_step;
  });
  std::set<Copy> fed;
  for (std::uint32_t i = 0; i < starts; ++i) fed.insert({i, 0});
  std::erase_if(moves, [&](const TimedMove& move) {
    if (!fed.contains(from_of(move))) return true;
    fed.insert(to_of(move));
    return false;
  });
  std::set<Copy> drained;
  std::vector<TimedMove> left;
  for (auto move = moves.rbegin(); move != moves.rend(); ++move) {
    const bool is_goal = move->to >= starts && move->to < starts + goals;
    if (!is_goal && !drained.contains(to_of(*move))) continue;
    drained.insert(from_of(*move));
    left.push_back(*move);
  }
  moves.assign(left.rbegin(), left.rend());
}

// Steps at which something other than waiting happens, node by node; the last one of a goal is
// when its sink closes.
std::set<Copy> events_of(const std::vector<TimedMove>& moves, std::size_t starts,
                         std::size_t goals) {
  std::set<Copy> events;
  std::set<Copy> left;
  for (std::uint32_t i = 0; i < starts; ++i) events.insert({i, 0});
  for (const TimedMove& move : moves) {
    if (waits(move)) continue;
    events.insert(from_of(move));
    events.insert(to_of(move));
    left.insert(from_of(move));
  }
  for (auto j = static_cast<std::uint32_t>(starts); j < starts + goals; ++j) {
    const auto after = events.lower_bound({j + 1, 0});
    SWARM_ASSERT(after != events.begin() && std::prev(after)->node == j);
    const Copy last = *std::prev(after);
    // Mass leaves the goal at the step of the last arrival. A sink has no leg out, so that it
    // closes one step later.
    if (left.contains(last)) events.insert({j, last.step + 1});
  }
  return events;
}

}  // namespace

// Nodes of the plan are the events; starts get the first indices and goals the next, which makes
// sources()[i] and sinks()[j] the components. Waiting steps between two events of a node merge into
// one leg.
Result<TimedPlan> timed_plan(std::span<const Gaussian> nodes, std::span<const double> supplies,
                             std::span<const double> demands, std::vector<TimedMove> moves,
                             double step_s) {
  const std::size_t starts = supplies.size();
  const std::size_t goals = demands.size();
  drop_negligible(moves, starts, goals);
  const std::set<Copy> events = events_of(moves, starts, goals);

  std::map<Copy, std::uint32_t> index;
  for (std::uint32_t i = 0; i < starts; ++i) index[{i, 0}] = i;
  for (auto j = static_cast<std::uint32_t>(starts); j < starts + goals; ++j) {
    index[*std::prev(events.lower_bound({j + 1, 0}))] = j;
  }
  for (const Copy& event : events) {
    index.try_emplace(event, static_cast<std::uint32_t>(index.size()));
  }
  std::vector<PlanNode> plan_nodes(index.size());
  std::vector<std::uint32_t> roadmap_node(index.size());
  for (const auto& [copy, i] : index) {
    roadmap_node[i] = copy.node;
    plan_nodes[i] = {nodes[copy.node], MissionTime(copy.step * step_s), 0.0};
  }
  for (std::size_t i = 0; i < starts; ++i) plan_nodes[i].mass = supplies[i];

  std::vector<PlanLeg> legs;
  for (const TimedMove& move : moves) {
    const auto from = index.find(from_of(move));
    // Waiting goes on from the last event to the next one; at a goal, it ends with the sink.
    if (from == index.end()) continue;
    auto to = index.find(to_of(move));
    if (waits(move)) {
      to = std::next(from);
      if (to == index.end() || to->first.node != move.from) continue;
    }
    legs.push_back({from->second, to->second, move.mass});
    plan_nodes[to->second].mass += move.mass;
  }
  Result<FlowPlan> plan = FlowPlan::make(std::move(plan_nodes), std::move(legs));
  if (!plan) return tl::unexpected(plan.error());
  return TimedPlan{*std::move(plan), std::move(roadmap_node)};
}

}  // namespace swarm::planner
