// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner_service/roadmap/roadmap.hpp"

namespace swarm::planner {

/// Shortest ways on the roadmap from one node.
class ShortestRoutes {
 public:
  /// Dijkstra from `source`; stops as soon as all `targets` are settled.
  ShortestRoutes(const Roadmap& roadmap, std::uint32_t source,
                 std::span<const std::uint32_t> targets);

  /// Length of the way to a target [m]; +∞ when there is none.
  double length_m(std::uint32_t target) const { return length_m_[target]; }

  /// Nodes on the way, source and target included; empty when there is none.
  std::vector<std::uint32_t> nodes_to(std::uint32_t target) const;

 private:
  std::vector<double> length_m_;
  std::vector<std::uint32_t> previous_;
};

}  // namespace swarm::planner
