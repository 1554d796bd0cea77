// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/transport/shortest_routes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace swarm::planner {

ShortestRoutes::ShortestRoutes(const Roadmap& roadmap, std::uint32_t source,
                               std::span<const std::uint32_t> targets)
    : length_m_(roadmap.nodes.size(), std::numeric_limits<double>::infinity()),
      previous_(roadmap.nodes.size(), source) {
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::size_t targets_left = targets.size();
  length_m_[source] = 0.0;
  queue.emplace(0.0, source);
  while (!queue.empty() && targets_left > 0) {
    const auto [length_m, node] = queue.top();
    queue.pop();
    if (length_m > length_m_[node]) continue;  // an older, longer entry of a settled node
    targets_left -= static_cast<std::size_t>(std::count(targets.begin(), targets.end(), node));
    for (const Roadmap::Arc& arc : roadmap.arcs_of(node)) {
      const double through_m = length_m + arc.length_m;
      if (through_m >= length_m_[arc.to]) continue;
      length_m_[arc.to] = through_m;
      previous_[arc.to] = node;
      queue.emplace(through_m, arc.to);
    }
  }
}

std::vector<std::uint32_t> ShortestRoutes::nodes_to(std::uint32_t target) const {
  std::vector<std::uint32_t> nodes;
  if (!std::isfinite(length_m_[target])) return nodes;
  // The source is its own predecessor.
  std::uint32_t node = target;
  for (; previous_[node] != node; node = previous_[node]) nodes.push_back(node);
  nodes.push_back(node);
  std::reverse(nodes.begin(), nodes.end());
  return nodes;
}

}  // namespace swarm::planner
