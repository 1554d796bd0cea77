// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/box.hpp"

namespace swarm {

/// Finds the boxes near a point or near another box. Up to kScanned boxes are tested one by one;
/// more are kept in a binary tree of bounding boxes, where a query takes O(log n + matches).
///
/// A value type: copies are deep, and const functions may run in several threads at once. Boxes are
/// identified by their index in the vector that the constructor was given.
class BoxIndex {
 public:
  /// Up to this many boxes a scan is as fast as the tree (benchmark BM_BoxQuery).
  static constexpr std::size_t kScanned = 8;

  /// An index without boxes: every query finds nothing.
  BoxIndex() = default;
  /// Builds the tree in O(n log n). \pre boxes are finite, with min_m ≤ max_m; they may overlap
  explicit BoxIndex(std::vector<Box> boxes);

  /// The indexed boxes, in the order in which they were given.
  const std::vector<Box>& boxes() const { return boxes_; }

  /// Calls `is_it(i)` for every box i within `reach_m` of `query`, in no particular order, until a
  /// call returns true. Boxes that are farther by rounding alone (1 nm and 1e-12 of the
  /// coordinates) may be visited too, so the predicate decides. Does not allocate.
  /// \param query box around which to search; a point p is the box {p, p}
  /// \param reach_m largest distance between the boxes [m]; a negative one counts as 0
  /// \param is_it predicate, `bool(std::uint32_t index)`
  /// \return whether a call returned true
  template <class Predicate>
  bool any_within(const Box& query, double reach_m, Predicate&& is_it) const {
    const double reach_squared = widened_squared(reach_m);
    if (tree_.empty()) {
      for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
        if (query.gap_squared_m2(boxes_[i]) <= reach_squared && is_it(i)) return true;
      }
      return false;
    }
    for (std::uint32_t at = 0; at < tree_.size();) {
      const Node& node = tree_[at];
      if (query.gap_squared_m2(node.box) > reach_squared) {
        at = node.skip;
        continue;
      }
      for (std::uint32_t i = node.first; i < node.last; ++i) {
        if (query.gap_squared_m2(boxes_[order_[i]]) <= reach_squared && is_it(order_[i])) {
          return true;
        }
      }
      ++at;
    }
    return false;
  }

  /// Calls `visit(i)` for every box within `reach_m` of `query` in ascending order of i: a result
  /// that depends on the order (the first of several equal distances) is the one of a plain scan.
  /// Allocates only if more than 64 boxes match.
  /// \param query box around which to search; a point p is the box {p, p}
  /// \param reach_m largest distance between the boxes [m]; a negative one counts as 0
  /// \param visit visitor, `void(std::uint32_t index)`
  template <class Visitor>
  void for_each_within(const Box& query, double reach_m, Visitor&& visit) const {
    if (tree_.empty()) {
      any_within(query, reach_m, [&](std::uint32_t i) { return visit(i), false; });
      return;
    }
    std::array<std::uint32_t, 64> few;
    std::vector<std::uint32_t> all;
    std::size_t count = 0;
    any_within(query, reach_m, [&](std::uint32_t i) {
      if (count == few.size()) all.assign(few.begin(), few.end());
      if (count >= few.size()) all.push_back(i);
      if (count < few.size()) few[count] = i;
      ++count;
      return false;
    });
    const std::span found = all.empty() ? std::span(few).first(count) : std::span(all);
    std::sort(found.begin(), found.end());
    for (const std::uint32_t i : found) visit(i);
  }

  /// Calls `visit(i)` for the up to four boxes of one leaf of the tree near a point. These are
  /// likely, but not certain, to include the nearest box: their smallest distance is an upper bound
  /// with which any_within() and for_each_within() visit less. Without a tree (up to kScanned
  /// boxes) nothing is visited. O(log n), does not allocate.
  template <class Visitor>
  void for_some_near(const Vec2& point_m, Visitor&& visit) const {
    if (tree_.empty()) return;
    std::uint32_t at = 0;
    while (tree_[at].first == tree_[at].last) {
      const std::uint32_t left = at + 1;
      const std::uint32_t right = tree_[left].skip;
      at = tree_[left].box.distance_m(point_m) <= tree_[right].box.distance_m(point_m) ? left
                                                                                       : right;
    }
    for (std::uint32_t i = tree_[at].first; i < tree_[at].last; ++i) visit(order_[i]);
  }

 private:
  // Nodes are in depth-first order: a node's first child follows it, `skip` is the index behind its
  // last descendant.
  struct Node {
    Box box;
    std::uint32_t skip = 0;
    std::uint32_t first = 0;  // range [first, last) of order_ in a leaf; empty in an inner node
    std::uint32_t last = 0;
  };

  void build(std::uint32_t first, std::uint32_t last);

  // Callers compute distances by other formulas than boxes do: rounding must not hide a box.
  double widened_squared(double reach_m) const {
    const double widened_m = std::max(0.0, reach_m) * (1.0 + 1e-12) + hair_m_;
    return widened_m * widened_m;
  }

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> tree_;
  double hair_m_ = 0.0;
};

}  // namespace swarm
