// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <nanoflann.hpp>

#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

// The interface that nanoflann requires of a point cloud; the names are its own.
struct MeanCloud {
  std::span<const Gaussian> nodes;
  std::size_t kdtree_get_point_count() const { return nodes.size(); }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return nodes[index].mean_m()(static_cast<Eigen::Index>(axis));
  }
  template <class BBox>
  bool kdtree_get_bbox(BBox&) const {
    return false;
  }
};

using MeanTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, MeanCloud>, MeanCloud,
                                        2, std::uint32_t>;

// Slightly more than the squared radius, so that rounding does not exclude a pair with W₂ = r.
double widened_squared(double reach_m) { return reach_m * reach_m * (1.0 + 1e-12); }

// Radius of a terminal: at least the connection radius and twice the W₂ distance to its nearest
// sample.
double terminal_radius_m(std::span<const Gaussian> nodes, const Gaussian& terminal,
                         std::size_t terminals, double radius_m) {
  double nearest_m2 = std::numeric_limits<double>::infinity();
  for (const Gaussian& sample : nodes.subspan(terminals)) {
    if ((sample.mean_m() - terminal.mean_m()).squaredNorm() >= nearest_m2) continue;
    nearest_m2 = std::min(nearest_m2, wasserstein2_squared(terminal, sample));
  }
  return std::isfinite(nearest_m2) ? std::max(radius_m, 2.0 * std::sqrt(nearest_m2)) : radius_m;
}

}  // namespace

std::vector<NeighbourPair> terminal_neighbours(std::span<const Gaussian> nodes,
                                               std::uint32_t terminal, std::size_t terminals,
                                               double radius_m) {
  const Gaussian& from = nodes[terminal];
  const double reach_m = terminal_radius_m(nodes, from, terminals, radius_m);
  std::vector<NeighbourPair> pairs;
  for (std::uint32_t b = terminal + 1; b < nodes.size(); ++b) {
    if ((nodes[b].mean_m() - from.mean_m()).squaredNorm() > widened_squared(reach_m)) continue;
    const double distance_m = wasserstein2(from, nodes[b]);
    if (distance_m <= reach_m) pairs.push_back({terminal, b, distance_m});
  }
  return pairs;
}

std::vector<NeighbourPair> find_neighbours(std::span<const Gaussian> nodes, double radius_m,
                                           std::size_t terminals) {
  terminals = std::min(terminals, nodes.size());
  std::vector<NeighbourPair> pairs;
  pairs.reserve(16 * nodes.size());
  for (std::uint32_t a = 0; a < terminals; ++a) {
    const auto found = terminal_neighbours(nodes, a, terminals, radius_m);
    pairs.insert(pairs.end(), found.begin(), found.end());
  }
  if (nodes.size() == terminals) return pairs;
  const auto first = static_cast<std::uint32_t>(terminals);
  const MeanCloud cloud{nodes.subspan(terminals)};
  const MeanTree tree(2, cloud);
  const nanoflann::SearchParams any_order(32, 0.0F, false);
  std::vector<std::pair<std::uint32_t, double>> found;
  for (std::uint32_t a = first; a < nodes.size(); ++a) {
    found.clear();
    // The tree returns a superset by the distance of means; the test of W₂ decides.
    tree.radiusSearch(nodes[a].mean_m().data(), widened_squared(radius_m), found, any_order);
    const auto begin = static_cast<std::ptrdiff_t>(pairs.size());
    for (const auto& [index, squared] : found) {
      const std::uint32_t b = first + index;
      if (b <= a) continue;
      const double distance_m = wasserstein2(nodes[a], nodes[b]);
      if (distance_m <= radius_m) pairs.push_back({a, b, distance_m});
    }
    std::sort(pairs.begin() + begin, pairs.end(),
              [](const NeighbourPair& l, const NeighbourPair& r) { return l.b < r.b; });
  }
  return pairs;
}

}  // namespace swarm::planner
