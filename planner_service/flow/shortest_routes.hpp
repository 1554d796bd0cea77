// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/planning/roadmap.hpp"

namespace swarm::planner {

/// Shortest paths on the roadmap from one node.
class ShortestRoutes {
 public:
  /// Label-correcting search with buckets of length: like Dijkstra's, but nodes whose lengths are
  /// nearly equal come in any order, so that no heap is needed. Stops as soon as the lengths of all
  /// `targets` are final; without targets, when those of all nodes are.
  ShortestRoutes(const Roadmap& roadmap, std::uint32_t source,
                 std::span<const std::uint32_t> targets);

  /// Length of the path to a target [m]; +∞ when there is none.
  double length_m(std::uint32_t target) const { return length_m_[target]; }

  /// Nodes on the path, source and target included; empty when there is none.
  std::vector<std::uint32_t> nodes_to(std::uint32_t target) const;

 private:
  std::vector<double> length_m_;
  std::vector<std::uint32_t> previous_;
};

/// Shortest paths from every start to every goal. The roadmap has no direction, so the searches
/// begin on the side with fewer nodes.
class RouteTable {
 public:
  RouteTable(const Roadmap& roadmap, std::span<const std::uint32_t> starts,
             std::span<const std::uint32_t> goals);

  /// Length of the path from start i to goal j [m]; +∞ when there is none.
  double length_m(std::size_t start, std::size_t goal) const;

  /// Nodes on the path from start i to goal j, both included; empty when there is none.
  std::vector<std::uint32_t> nodes(std::size_t start, std::size_t goal) const;

 private:
  std::vector<std::uint32_t> starts_;
  std::vector<std::uint32_t> goals_;
  bool from_goals_;
  std::vector<ShortestRoutes> searches_;
};

}  // namespace swarm::planner
