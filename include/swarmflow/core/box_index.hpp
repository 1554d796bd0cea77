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

/// Finds the boxes near a place. Few boxes are looked at one by one; more are in a tree of bounding
/// boxes, O(log n + answers) a query. Copies freely, shares nothing.
class BoxIndex {
 public:
  /// Up to this many boxes, going through them is as fast as the tree (BM_BoxQuery).
  static constexpr std::size_t kScanned = 8;

  BoxIndex() = default;
  explicit BoxIndex(std::vector<Box> boxes);

  const std::vector<Box>& boxes() const { return boxes_; }

  /// Calls `is_it(i)` for all boxes i within `reach_m` of `query`, and at most those a hair
  /// farther, until one says true; whether one did. In no particular order.
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

  /// The same for all of them in ascending order, so that what depends on the order is what a scan
  /// of all boxes gives.
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

  /// Calls `visit(i)` for a few boxes that are likely the nearest to a point: enough for a bound on
  /// what the nearest is. None where boxes are few and a scan needs no bound.
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
  // In depth-first order: a node's first child follows it, and past its last descendant is `skip`.
  struct Node {
    Box box;
    std::uint32_t skip = 0;
    std::uint32_t first = 0;  // of order_, in a leaf; an inner node has none of its own
    std::uint32_t last = 0;
  };

  void build(std::uint32_t first, std::uint32_t last);

  // The tests that decide take distances otherwise than boxes do: rounding must not hide a box.
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
