// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/horizon_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

}  // namespace

// Unrolls the graph over h stages, breadth first from the sources: a vertex enters layer p when an
// arc from layer p − 1 reaches it. Columns are appended stage by stage; the order is relied upon
// below.
HorizonNetwork::HorizonNetwork(const RiskGraph& graph, std::span<const VertexMass> sources,
                               std::span<const double> goal_weights, const HorizonCosts& costs)
    : horizon_(costs.horizon),
      vertices_(graph.vertices().size()),
      arcs_(graph.arcs().size()),
      sources_(sources.size()),
      goals_(graph.goals()) {
  SWARM_ASSERT(horizon_ >= 1 && goal_weights.size() == goals_);
  const double unit_m = graph.options().collocation.spacing_m;
  row_of_.assign(horizon_ + 1, std::vector<int>(vertices_, -1));
  std::vector<std::uint32_t> layer;
  // Adds a vertex to a layer with its balance row; the right side is its mass in layer 0, else 0.
  const auto join = [&](std::size_t step, std::uint32_t vertex, double mass,
                        std::vector<std::uint32_t>& members) {
    row_of_[step][vertex] = static_cast<int>(right_side_.size());
    right_side_.push_back(mass);
    members.push_back(vertex);
  };
  for (const VertexMass& source : sources) join(0, source.vertex, source.mass, layer);
  for (std::uint32_t stage = 0; stage < horizon_; ++stage) {
    const double lambda = costs.lambda_stage * (1.0 + costs.impatience * stage);
    std::vector<std::uint32_t> next;
    for (const std::uint32_t from : layer) {
      std::uint32_t index = graph.first_arc_of(from);
      for (const RiskGraph::Arc& arc : graph.arcs_of(from)) {
        if (!in_layer(stage + 1, arc.to)) join(stage + 1, arc.to, 0.0, next);
        const double path = arc.w2_m / unit_m;
        columns_.push_back({stage, from, arc.to, index++, lambda * path * path});
      }
    }
    layer = std::move(next);
  }
  // The terminal transport (11e): from every vertex of the last layer to every goal component that
  // a path of the graph reaches, at the cost of the squared path length Q.
  goal_row_ = right_side_.size();
  right_side_.insert(right_side_.end(), goal_weights.begin(), goal_weights.end());
  for (const std::uint32_t from : layer) {
    for (std::uint32_t n = 0; n < goals_; ++n) {
      const double path = graph.to_goal_m(from, n) / unit_m;
      if (!std::isfinite(path)) continue;
      columns_.push_back(
          {static_cast<std::uint32_t>(horizon_), from, n, 0, costs.lambda_terminal * path * path});
    }
  }
}

// Cheapest path to one goal from every row, by backward dynamic programming: O(columns).
HorizonNetwork::Paths HorizonNetwork::paths_to(std::size_t goal) const {
  Paths paths{std::vector<double>(goal_row_, kUnbounded),
              std::vector<std::size_t>(goal_row_, columns_.size())};
  // Columns are ordered by stage: from the last to the first every layer is ready when it is read.
  for (std::size_t c = columns_.size(); c-- > 0;) {
    const Column& column = columns_[c];
    if (column.stage == horizon_ && column.to != goal) continue;
    const double beyond =
        column.stage == horizon_ ? 0.0 : paths.cost[row(column.stage + 1, column.to)];
    const std::size_t from = row(column.stage, column.from);
    if (column.cost + beyond >= paths.cost[from]) continue;
    paths.cost[from] = column.cost + beyond;
    paths.column[from] = c;
  }
  return paths;
}

// The first rows are the sources, in their order; from each the stored columns are followed to the
// terminal transport.
std::vector<std::size_t> HorizonNetwork::cheapest_routes() const {
  std::vector<std::size_t> routes;
  for (std::size_t n = 0; n < goals_; ++n) {
    const Paths paths = paths_to(n);
    for (std::size_t source = 0; source < sources_; ++source) {
      for (std::size_t c = paths.column[source]; c < columns_.size();) {
        routes.push_back(c);
        if (columns_[c].stage == horizon_) break;
        c = paths.column[row(columns_[c].stage + 1, columns_[c].to)];
      }
    }
  }
  return routes;
}

// For each goal one forward pass adds costs from the sources to the costs to go: O(columns ·
// goals).
std::vector<double> HorizonNetwork::detours() const {
  std::vector<double> least(columns_.size(), kUnbounded);
  for (std::size_t n = 0; n < goals_; ++n) {
    const std::vector<double> to_go = paths_to(n).cost;
    // Least cost from a source, minus the cost of that source's cheapest path to the goal.
    std::vector<double> so_far(goal_row_, kUnbounded);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const Column& column = columns_[c];
      if (column.stage == horizon_ && column.to != n) continue;
      const std::size_t from = row(column.stage, column.from);
      if (column.stage == 0 && std::isfinite(to_go[from])) so_far[from] = -to_go[from];
      const double through = so_far[from] + column.cost;
      if (column.stage == horizon_) {
        least[c] = std::min(least[c], through);
        continue;
      }
      const std::size_t to = row(column.stage + 1, column.to);
      so_far[to] = std::min(so_far[to], through);
      if (std::isfinite(to_go[to])) least[c] = std::min(least[c], through + to_go[to]);
    }
  }
  return least;
}

std::vector<double> HorizonNetwork::vertex_weights(std::size_t step,
                                                   std::span<const double> x) const {
  std::vector<double> weights(vertices_, 0.0);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].stage + 1 == step) weights[columns_[c].to] += std::max(0.0, x[c]);
  }
  return weights;
}

std::vector<double> HorizonNetwork::arc_weights(std::size_t step, std::span<const double> x) const {
  std::vector<double> weights(arcs_, 0.0);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].stage + 1 == step) weights[columns_[c].arc] = std::max(0.0, x[c]);
  }
  return weights;
}

}  // namespace swarm::planner
