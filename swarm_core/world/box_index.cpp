// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/box_index.hpp"

#include <numeric>
#include <utility>

namespace swarm {
namespace {

// Boxes in a leaf: scanning a few is cheaper than another level of the tree.
constexpr std::uint32_t kLeaf = 4;

Box hull(const Box& a, const Box& b) {
  return {a.min_m.cwiseMin(b.min_m), a.max_m.cwiseMax(b.max_m)};
}

}  // namespace

// A static bounding volume hierarchy. Few boxes are scanned without a tree. `hair_m_` covers the
// rounding of distances, which grows with the coordinates.
BoxIndex::BoxIndex(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
  double farthest_m = 0.0;
  for (const Box& box : boxes_) {
    farthest_m =
        std::max({farthest_m, box.min_m.cwiseAbs().maxCoeff(), box.max_m.cwiseAbs().maxCoeff()});
  }
  hair_m_ = 1e-9 + 1e-12 * farthest_m;
  if (boxes_.size() <= kScanned) return;
  order_.resize(boxes_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  build(0, static_cast<std::uint32_t>(boxes_.size()));
}

// Splits the boxes at the median of their centres along the axis on which the centres spread most:
// the depth is log₂ n for any input, equal boxes included.
void BoxIndex::build(std::uint32_t first, std::uint32_t last) {
  const std::size_t at = tree_.size();
  tree_.emplace_back();
  Box box = boxes_[order_[first]];
  Box centres{box.min_m + box.max_m, box.min_m + box.max_m};
  for (std::uint32_t i = first + 1; i < last; ++i) {
    const Box& other = boxes_[order_[i]];
    const Vec2 centre = other.min_m + other.max_m;
    box = hull(box, other);
    centres = hull(centres, {centre, centre});
  }
  tree_[at].box = box;
  if (last - first <= kLeaf) {
    tree_[at].first = first;
    tree_[at].last = last;
  } else {
    const Vec2 size = centres.max_m - centres.min_m;
    const Eigen::Index axis = size.x() >= size.y() ? 0 : 1;
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](std::uint32_t l, std::uint32_t r) {
                       const double left = boxes_[l].min_m(axis) + boxes_[l].max_m(axis);
                       const double right = boxes_[r].min_m(axis) + boxes_[r].max_m(axis);
                       return left != right ? left < right : l < r;
                     });
    build(first, middle);
    build(middle, last);
  }
  // Nodes are stored in depth-first order, so a query that rejects a node goes on at `skip`, behind
  // its subtree, and needs no stack.
  tree_[at].skip = static_cast<std::uint32_t>(tree_.size());
}

}  // namespace swarm
