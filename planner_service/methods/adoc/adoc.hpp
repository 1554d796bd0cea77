// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "planner_service/flow/route.hpp"
#include "planner_service/roadmap/collocation.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/world.hpp"

/// The baseline of both papers in the style of ADOC (adaptive distributed optimal control):
/// obstacles on a grid map, their overlap with the swarm's Gaussians penalised, no guarantee
/// about risk.
namespace swarm::planner {

/// The map as cells, a cell being taken when its centre is in an obstacle.
class ObstacleGrid {
 public:
  /// kBadInput when the cell is not positive or there would be more than 10⁷.
  static Result<ObstacleGrid> make(const World& world, double cell_m);

  /// The inner product ∫ g(x) 1_O(x) dx, the share of a Gaussian that is in obstacles: g at the
  /// centres of the taken cells within 5 σ, times their area. The error is that of the obstacles'
  /// outline on the grid, about cell · outline · density.
  double inner_product(const Gaussian& g) const;

 private:
  Vec2 origin_m_ = Vec2::Zero();
  double cell_m_ = 1.0;
  std::int64_t columns_ = 0;
  std::int64_t rows_ = 0;
  std::vector<std::uint8_t> taken_;
};

/// Numbers of the method, lengths in metres.
struct AdocOptions {
  CollocationOptions collocation{};
  double transport_radius_m = 22.5;
  double penalty =
      20.0;  ///< of the inner product: an arc costs W₂ (1 + penalty · mean of its ends)
  double cell_m = 1.0;
  /// The paths of means keep this from obstacles; robots could not pass through one.
  double mean_clearance_m = 1.0;
};

/// Cheapest paths over start and goal components and the collocation set, and the transport problem
/// (13) on them. kInfeasible names components that no path joins.
Result<std::vector<Route>> adoc_routes(const World& world, const Mixture& start,
                                       const Mixture& goal, const AdocOptions& options);

}  // namespace swarm::planner
