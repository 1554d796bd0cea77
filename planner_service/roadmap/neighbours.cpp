// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nanoflann.hpp>

#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

// What nanoflann asks of a point cloud; the names are its own.
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

double terminal_radius_m(std::span<const Gaussian> nodes, const Gaussian& terminal,
                         std::size_t terminals, double radius_m) {
  double nearest_m2 = std::numeric_limits<double>::infinity();
  for (const Gaussian& sample : nodes.subspan(terminals)) {
    nearest_m2 = std::min(nearest_m2, wasserstein2_squared(terminal, sample));
  }
  return std::isfinite(nearest_m2) ? std::max(radius_m, 2.0 * std::sqrt(nearest_m2)) : radius_m;
}

}  // namespace

std::vector<NeighbourPair> find_neighbours(std::span<const Gaussian> nodes, double radius_m,
                                           std::size_t terminals) {
  std::vector<NeighbourPair> pairs;
  if (nodes.empty()) return pairs;
  pairs.reserve(16 * nodes.size());
  const MeanCloud cloud{nodes};
  const MeanTree tree(2, cloud);
  const nanoflann::SearchParams any_order(32, 0.0F, false);
  std::vector<std::pair<std::uint32_t, double>> found;
  for (std::uint32_t a = 0; a < nodes.size(); ++a) {
    found.clear();
    const double reach_m =
        a < terminals ? terminal_radius_m(nodes, nodes[a], terminals, radius_m) : radius_m;
    // The tree's ball is open; the relative hair lets W₂ = r count, the exact test below decides.
    const double reach_m2 = reach_m * reach_m * (1.0 + 1e-12);
    tree.radiusSearch(nodes[a].mean_m().data(), reach_m2, found, any_order);
    const std::size_t first = pairs.size();
    for (const auto& [b, squared] : found) {
      if (b <= a) continue;
      const double distance_m = wasserstein2(nodes[a], nodes[b]);
      if (distance_m <= reach_m) pairs.push_back({a, b, distance_m});
    }
    std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.end(),
              [](const NeighbourPair& l, const NeighbourPair& r) { return l.b < r.b; });
  }
  return pairs;
}

}  // namespace swarm::planner
