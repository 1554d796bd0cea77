// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "planner_service/flow/route.hpp"
#include "planner_service/roadmap/means.hpp"
#include "planner_service/roadmap/neighbours.hpp"
#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/planning/roadmap.hpp"

namespace swarm::planner {

/// Numbers of the paper's own experiments, whose robots have a radius of 4 pixels: at 0.05 m a
/// pixel that is ours, 0.2 m.
struct CropsOptions {
  std::size_t samples = 300;          ///< N
  double connection_radius_m = 4.0;   ///< 80 px
  std::uint32_t neighbours_max = 20;  ///< k: edges that a node requests at most
  double clearance_min_m = 0.5;  ///< 10 px; nodes nearer to an obstacle or the bounds are discarded
  double sigma_min_m = 0.05;     ///< edges have room for it: clearance ≥ k σ_min − δ
  /// p: 3 in the paper, 1 in its code. On the scenes of the code, paths at p = 1 are up to 18 %
  /// longer than the shortest on the graph, at p = 3 up to 23 %; around scattered obstacles p = 3
  /// may double the path.
  double clearance_power = 3.0;
  double goal_radius_m = 1.0;     ///< 20 px; circle around a path vertex, two σ of its Gaussian
  std::uint32_t rounds_max = 20;  ///< how often N/2 + 1 samples are added until all is joined
  double stuck_factor = 3.0;      ///< cost factor of edges where robots are stuck
  std::uint32_t stuck_edges = 4;  ///< number of edges ahead of a stuck robot that get the factor
};

/// w(q) = (Σ_o dist(q, o))^p over the obstacles of the world            [CRoPS, roadmap weights];
/// 1 in a world without. \pre q is free
double clearance_weight(const World& world, const Vec2& point_m, double power);

/// Cost of an edge, ‖q_i, q_j‖ / min(w(q_i), w(q_j))                    [CRoPS, roadmap weights].
double guide_cost(double length_m, double weight_i, double weight_j);

/// The guide of CRoPS: a probabilistic roadmap of points whose edge costs prefer open space, and
/// the cheapest paths on it, as a flow.
///
/// Path vertices become Gaussians with σ = goal_radius_m/2 in every direction, or as much as the
/// clearance of the legs beside them allows: σ ≤ (clearance + δ)/k. A W₂ geodesic between two of
/// these is no wider than the wider one, so CVaR ≤ δ holds along the whole leg. Where the leg from
/// a start component (or to a goal component) itself breaks δ, it first contracts in place: both
/// shapes keep δ at one mean, so all between them do.
///
/// Samples are a shifted Halton sequence, not uniform as in the paper: on the scene3 of its code
/// 453 nodes join start and goal (median of 21 seeds) where uniform ones take 755.
///
/// Deterministic for a given generator state. O(rounds · samples · (neighbours · edges of the
/// obstacles)). Keeps a reference to the world.
class CropsGuide {
 public:
  /// Samples and connects until every start component is joined to every goal component, or, when
  /// rounds_max is used up, until the transport problem has a solution.
  ///
  /// kInfeasible: a component breaks the risk limit at its own position, or none of the above;
  /// names it and the parameters to loosen. \pre lengths ≥ 0, σ_min ≥ Gaussian::kMinSigma_m,
  /// goal_radius_m ≥ 2 σ_min, stuck_factor ≥ 1; asserted
  static Result<CropsGuide> make(const World& world, const Mixture& start, const Mixture& goal,
                                 const RiskLimit& risk, const CropsOptions& options, Rng& rng);

  /// One route for each shipment of the transport problem over the paths' costs; waypoints start
  /// and end at the components. For build_plan().
  const std::vector<Route>& routes() const { return routes_; }

  /// The graph that was searched, for drawings. Nodes: start components, goal components, samples,
  /// each as the Gaussian of a path vertex in the open. `Arc::length_m` holds the guide's cost
  /// (m^(1−p)), not metres.
  const Roadmap& roadmap() const { return graph_; }

  /// Many robots of a route are stuck near this position: the edges of its path towards the next
  /// goals cost stuck_factor times as much, and all paths are searched anew (edges that cost 10⁶
  /// times their first cost do not rise further). Returns whether any route changed.
  bool reweight(std::size_t route, const Vec2& stuck_at_m);

  /// The route with a waypoint nearest to a position; nothing without routes.
  std::optional<std::size_t> route_near(const Vec2& at_m) const;

  /// New ends on the same samples, for a swarm in flight or another goal; what reweight() did to
  /// edges among the samples stays. Errors as make()'s, after which the guide has no routes.
  Result<void> move_ends(const Mixture& start, const Mixture& goal);

 private:
  CropsGuide(const World& world, const RiskLimit& risk, const CropsOptions& options);

  std::size_t terminals() const { return starts_.size() + goals_.size(); }
  Result<void> set_ends(const Mixture& start, const Mixture& goal);
  std::size_t add_samples(std::size_t count, HaltonMeans& means);
  void connect();
  bool is_visible(const NeighbourPair& pair, double clearance_m);
  bool search();
  Error no_path() const;
  double sigma_beside_m(const Vec2& from_m, const Vec2& to_m) const;
  Waypoints waypoints_along(const std::vector<std::uint32_t>& path, const Gaussian& start,
                            const Gaussian& goal) const;

  const World* world_;
  RiskLimit risk_;
  CropsOptions options_;
  double k_;                 // of the risk limit
  double edge_clearance_m_;  // k σ_min − δ
  std::vector<WeightedGaussian> starts_;
  std::vector<WeightedGaussian> goals_;
  std::vector<Vec2> points_m_;      // start means, goal means, samples
  std::vector<double> weights_;     // w of each
  std::vector<double> first_cost_;  // of each arc, before any re-weighting
  Roadmap graph_;
  std::unordered_map<std::uint64_t, bool> visible_;  // pairs of samples, by their numbers
  std::vector<double> costs_;  // of the cheapest paths, row-major [starts × goals]
  std::vector<Route> routes_;
  std::vector<std::vector<std::uint32_t>> paths_;  // of each route, in nodes
};

}  // namespace swarm::planner
