// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/adoc/adoc.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "planner_service/flow/cheapest_paths.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/neighbours.hpp"

namespace swarm::planner {
namespace {

// Limits the memory of the grid to 10 MB.
constexpr double kMaxCells = 1e7;
// Cells farther than this are left out of the inner product: their share is below 1e-5.
constexpr double kReachSigmas = 5.0;

Result<void> check(const AdocOptions& options) {
  if (options.transport_radius_m > 0.0 && options.penalty >= 0.0 &&
      std::isfinite(options.penalty) && options.mean_clearance_m >= 0.0) {
    return {};
  }
  return fail(ErrorCode::kBadInput,
              fmt::format("ADOC: transport radius {} m must be > 0, penalty {} and mean clearance "
                          "{} m >= 0",
                          options.transport_radius_m, options.penalty, options.mean_clearance_m));
}

// Start and goal components and the set, joined within the radius; lengths are costs.
Roadmap penalised_roadmap(std::vector<Gaussian> nodes, std::size_t terminals, const World& world,
                          const ObstacleGrid& grid, const AdocOptions& options) {
  std::vector<double> overlap;
  for (const Gaussian& g : nodes) overlap.push_back(grid.inner_product(g));
  std::vector<NeighbourPair> pairs = find_neighbours(nodes, options.transport_radius_m, terminals);
  std::erase_if(pairs, [&](const NeighbourPair& pair) {
    return !world.segment_is_free(nodes[pair.a].mean_m(), nodes[pair.b].mean_m(),
                                  options.mean_clearance_m);
  });
  for (NeighbourPair& pair : pairs) {
    pair.distance_m *= 1.0 + 0.5 * options.penalty * (overlap[pair.a] + overlap[pair.b]);
  }
  return assemble(std::move(nodes), pairs);
}

}  // namespace

// Marks a cell as taken when its centre is in an obstacle.
Result<ObstacleGrid> ObstacleGrid::make(const World& world, double cell_m) {
  const Vec2 size_m = world.bounds_m().max_m - world.bounds_m().min_m;
  const double columns = std::ceil(size_m.x() / cell_m);
  const double rows = std::ceil(size_m.y() / cell_m);
  if (!(cell_m > 0.0 && columns * rows <= kMaxCells)) {
    return fail(ErrorCode::kBadInput,
                fmt::format("obstacle grid: cells of {} m; they must be > 0 and at most {:g}",
                            cell_m, kMaxCells));
  }
  ObstacleGrid grid;
  grid.origin_m_ = world.bounds_m().min_m;
  grid.cell_m_ = cell_m;
  grid.columns_ = static_cast<std::int64_t>(columns);
  grid.rows_ = static_cast<std::int64_t>(rows);
  grid.taken_.reserve(static_cast<std::size_t>(columns * rows));
  for (std::int64_t row = 0; row < grid.rows_; ++row) {
    for (std::int64_t column = 0; column < grid.columns_; ++column) {
      const Vec2 offset(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
      grid.taken_.push_back(world.is_clear(grid.origin_m_ + cell_m * offset, 0.0) ? 0 : 1);
    }
  }
  return grid;
}

// Midpoint rule over the taken cells in the box of 5 σ around the mean, clamped to the grid.
double ObstacleGrid::inner_product(const Gaussian& g) const {
  const Mat2& covariance = g.covariance_m2();
  const auto range = [&](Eigen::Index axis, std::int64_t cells) {
    const double at = (g.mean_m()[axis] - origin_m_[axis]) / cell_m_;
    const double reach = kReachSigmas * std::sqrt(covariance(axis, axis)) / cell_m_;
    const auto limit = static_cast<double>(cells);
    return std::pair(static_cast<std::int64_t>(std::clamp(std::floor(at - reach), 0.0, limit)),
                     static_cast<std::int64_t>(std::clamp(std::ceil(at + reach), 0.0, limit)));
  };
  const auto [first_column, last_column] = range(0, columns_);
  const auto [first_row, last_row] = range(1, rows_);
  double sum = 0.0;
  for (std::int64_t row = first_row; row < last_row; ++row) {
    for (std::int64_t column = first_column; column < last_column; ++column) {
      if (taken_[static_cast<std::size_t>(row * columns_ + column)] == 0) continue;
      const Vec2 offset(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
      sum += g.density(origin_m_ + cell_m_ * offset);
    }
  }
  return sum * cell_m_ * cell_m_;
}

// The same transport problem as SwarmPRM, but over penalised arc costs instead of arcs that are
// proven.
Result<std::vector<Route>> adoc_routes(const World& world, const Mixture& start,
                                       const Mixture& goal, const AdocOptions& options) {
  if (auto checked = check(options); !checked) return tl::unexpected(checked.error());
  auto set = collocation_set(world.bounds_m(), options.collocation);
  if (!set) return tl::unexpected(set.error());
  auto grid = ObstacleGrid::make(world, options.cell_m);
  if (!grid) return tl::unexpected(grid.error());

  std::vector<Gaussian> nodes;
  for (const Mixture* mixture : {&start, &goal}) {
    for (const WeightedGaussian& component : mixture->components()) {
      nodes.push_back(component.gaussian);
    }
  }
  const std::size_t terminals = nodes.size();
  nodes.insert(nodes.end(), set->begin(), set->end());
  const Roadmap roadmap = penalised_roadmap(std::move(nodes), terminals, world, *grid, options);
  const PathTransport transport =
      transport_on_paths(roadmap, weights_of(start.components()), weights_of(goal.components()));
  if (transport.paths.empty()) {
    return fail(
        ErrorCode::kInfeasible,
        fmt::format("no path joins these start and goal components, and the swarm cannot avoid "
                    "them: {}; enlarge the transport radius ({} m), or shrink the mean clearance "
                    "({} m)",
                    unjoined_pairs(transport.costs, goal.components().size()),
                    options.transport_radius_m, options.mean_clearance_m));
  }
  std::vector<Route> routes;
  for (const auto& [shipment, path] : transport.paths) {
    Route route{shipment.from, shipment.to, shipment.mass, {}};
    for (const std::uint32_t node : path) route.waypoints.push_back(roadmap.nodes[node]);
    routes.push_back(std::move(route));
  }
  return routes;
}

}  // namespace swarm::planner
