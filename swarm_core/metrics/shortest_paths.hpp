// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm {

/// Shortest obstacle-avoiding distances between points inside the world's bounds, obstacles grown
/// by the robot's radius (visibility graph). Grown corners and circles are arcs approximated by
/// *inscribed* chords, so every distance is a lower bound of the true one, tight to a few
/// millimetres per corner. In a world with more corners than kMaxVertices the chords become coarser
/// and the smallest obstacles are left out: the bound stays a bound.
class ShortestPaths {
 public:
  /// Bound of the graph's vertices: its time grows with their square.
  static constexpr std::size_t kMaxVertices = 2000;

  /// Builds the visibility graph of the world. O(vertices² · parts).
  ShortestPaths(const World& world, double robot_radius_m);

  /// Matrix [from.size() × to.size()], row-major [m]; +∞ where no path exists. A point inside a
  /// grown obstacle may leave it freely, which keeps the result a lower bound.
  std::vector<double> distances_m(std::span<const Vec2> from, std::span<const Vec2> to) const;

 private:
  /// The outline of a grown convex obstacle.
  struct Part {
    std::vector<Vec2> vertices_m;  // convex, counter-clockwise
    Box box;
  };
  /// A corner of an outline at which a path may turn.
  struct Vertex {
    Vec2 at_m;
    Vec2 before_m, after_m;  // its neighbours on the part's outline
  };
  /// A straight piece of a path to a vertex.
  struct Edge {
    std::uint32_t to;
    double length_m;
  };

  std::vector<std::uint32_t> parts_around(const Vec2& p) const;
  bool blocks(std::uint32_t part, const Vec2& a, const Vec2& b,
              std::span<const std::uint32_t> ignored) const;
  bool visible(const Vec2& a, const Vec2& b, std::span<const std::uint32_t> ignored,
               std::uint32_t& last_blocker) const;
  std::vector<Edge> edges_from(const Vec2& p, std::span<const std::uint32_t> ignored) const;
  std::vector<double> distances_to_vertices(std::span<const Edge> first) const;

  Box bounds_m_;
  std::vector<Part> parts_;
  std::vector<Vertex> vertices_;
  std::vector<std::vector<Edge>> graph_;  // by vertex
};

}  // namespace swarm
