// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "planner_service/roadmap/collocation.hpp"
#include "swarm_core/risk/mixture_cvar.hpp"
#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// Parameters of the graph G.
struct RiskGraphOptions {
  CollocationOptions collocation{};
  double transport_radius_m = 22.5;  ///< of Assumption 2, in W₂: here 20 directions and waiting
  /// Distance that means and the segments between them keep from obstacles: robots near the mean
  /// follow its path.
  double mean_clearance_m = 1.0;
  double risk_weight = 1.0;  ///< κ of the arc lengths below
  /// (11g) is kept at this many times between two steps too, evenly spread: a step is long enough
  /// to carry a component past an obstacle's corner. 0 is the paper's.
  std::size_t checks_between = 1;
  RiskLimit risk{};  ///< δ is ROVER's ε
};

/// The directed graph G of ROVER, sec. III-A, and the distances to obstacles that the FTMPC needs,
/// made once (offline): vertices are the goal's components, then the collocation set but for
/// members whose mean is too near an obstacle. Arcs join vertices within the transport radius
/// (Assumption 2) when the segment between the means is clear; every vertex has an arc to itself,
/// which is waiting. The lengths
///
///   W₂(i, j) (1 + κ (rᵢ + rⱼ)/2),   r = max(0, CVaR_α(−sd) − ε) / (k(α) σ_max)
///
/// with r the risk of a single Gaussian, lead the shortest paths to the goal around narrow
/// passages.
class RiskGraph {
 public:
  /// A directed edge of the graph.
  struct Arc {
    std::uint32_t to = 0;
    double w2_m = 0.0;
    double length_m = 0.0;  ///< W₂ weighted by risk
  };

  /// A Gaussian so near a convex obstacle that its tail may reach it. The weight of `line` is
  /// unused.
  struct Near {
    std::uint32_t index = 0;  ///< of the vertex, or of the arc
    LineComponent line;
  };

  /// Beyond this many σ the tail has a probability below 1e-9 and an excess below that.
  static constexpr double kNearSigmas = 6.0;

  /// Keeps a reference to the world. O(vertices · (arcs + obstacles)) with boxes that rule most
  /// out. kBadInput for options out of range; kInfeasible when a goal component is too near an
  /// obstacle.
  static Result<RiskGraph> make(const World& world, const Mixture& goal,
                                const RiskGraphOptions& options);

  const World& world() const { return *world_; }
  const RiskGraphOptions& options() const { return options_; }
  const std::vector<Gaussian>& vertices() const { return vertices_; }
  std::size_t goals() const { return goals_; }
  /// The first of vertices(): goal components and C, without added sources.
  std::uint32_t own_vertices() const { return base_; }
  std::span<const Arc> arcs_of(std::uint32_t vertex) const {
    return std::span(arcs_).subspan(arc_offset_[vertex],
                                    arc_offset_[vertex + 1] - arc_offset_[vertex]);
  }

  std::span<const Arc> arcs() const { return arcs_; }
  std::uint32_t first_arc_of(std::uint32_t vertex) const { return arc_offset_[vertex]; }

  /// Length of the shortest path from a vertex to a goal component [m], +∞ when there is none: the
  /// root of Q(m, n) of (11a). Dijkstra from every goal, once.
  double to_goal_m(std::uint32_t vertex, std::size_t goal) const {
    return to_goal_m_[vertex * goals_ + goal];
  }

  /// The Gaussians near a convex obstacle of the world, by its index. Part 0: vertices. Parts f
  /// from 1 to checks_between: arcs, at f/(checks_between + 1) of their W₂ geodesic.
  std::span<const Near> near(std::size_t part, std::size_t obstacle) const {
    return near_[part][obstacle];
  }

  /// The vertex that equals a Gaussian to 1e-9, if any.
  std::optional<std::uint32_t> find(const Gaussian& g) const;

  /// Adds a Gaussian of the swarm that is not in C: arcs lead out of it, none in. They reach at
  /// least twice as far as to the nearest vertex, since its shape alone may be farther than a small
  /// radius. Nothing when its mean lies in an obstacle.
  std::optional<std::uint32_t> add_source(const Gaussian& g);

  /// Forgets all added sources.
  void drop_sources();

 private:
  void add_vertex(const Gaussian& g);
  void see_arcs_from(std::uint32_t first);
  double arc_length_m(double w2_m, std::uint32_t from, std::uint32_t to) const;
  void add_arcs(std::uint32_t from, std::uint32_t among);
  void search(std::size_t goal);

  const World* world_ = nullptr;
  RiskGraphOptions options_;
  double k_ = 0.0;
  std::size_t goals_ = 0;
  std::uint32_t base_ = 0;  // vertices without sources
  std::vector<Gaussian> vertices_;
  std::vector<double> risk_;         // r by vertex
  std::vector<double> clearance_m_;  // of the mean, by vertex
  std::vector<std::uint32_t> arc_offset_{0};
  std::vector<Arc> arcs_;
  std::vector<double> to_goal_m_;                     // [vertices × goals]
  std::vector<std::vector<std::vector<Near>>> near_;  // [part][obstacle]
};

}  // namespace swarm::planner
