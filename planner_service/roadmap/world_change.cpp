// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/world_change.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <tuple>

namespace swarm::planner {
namespace {

using Parts = std::span<const ConvexObstacle>;

bool point_less(const Vec2& a, const Vec2& b) {
  return std::tuple(a.x(), a.y()) < std::tuple(b.x(), b.y());
}

// Any strict order in which only equal shapes are equal.
bool shape_less(const ConvexObstacle& a, const ConvexObstacle& b) {
  if (a.vertices_m.empty() != b.vertices_m.empty()) return a.vertices_m.empty();
  if (a.vertices_m.empty()) {
    if (a.circle.center_m != b.circle.center_m) {
      return point_less(a.circle.center_m, b.circle.center_m);
    }
    return a.circle.radius_m < b.circle.radius_m;
  }
  return std::lexicographical_compare(a.vertices_m.begin(), a.vertices_m.end(),
                                      b.vertices_m.begin(), b.vertices_m.end(), point_less);
}

bool same_shape(const ConvexObstacle& a, const ConvexObstacle& b) {
  return !shape_less(a, b) && !shape_less(b, a);
}

// Cuts off equal parts at both ends of the lists. A scene usually changes in one obstacle, so that
// little is left to sort.
void drop_common_ends(Parts& before, Parts& after) {
  while (!before.empty() && !after.empty() && same_shape(before.front(), after.front())) {
    before = before.subspan(1);
    after = after.subspan(1);
  }
  while (!before.empty() && !after.empty() && same_shape(before.back(), after.back())) {
    before = before.first(before.size() - 1);
    after = after.first(after.size() - 1);
  }
}

std::vector<const ConvexObstacle*> sorted(Parts parts) {
  std::vector<const ConvexObstacle*> pointers;
  for (const ConvexObstacle& part : parts) pointers.push_back(&part);
  std::sort(pointers.begin(), pointers.end(),
            [](const auto* a, const auto* b) { return shape_less(*a, *b); });
  return pointers;
}

}  // namespace

// Merges the two sorted lists: a shape in one of them alone was added or removed.
WorldChange world_change(const World& before, const World& after) {
  Parts old_parts = before.convex_obstacles();
  Parts new_parts = after.convex_obstacles();
  drop_common_ends(old_parts, new_parts);
  const auto olds = sorted(old_parts);
  const auto sorted_new = sorted(new_parts);
  WorldChange change;
  std::size_t o = 0;
  std::size_t n = 0;
  while (o < olds.size() || n < sorted_new.size()) {
    if (n == sorted_new.size() || (o < olds.size() && shape_less(*olds[o], *sorted_new[n]))) {
      change.removed.push_back(olds[o++]->box);
    } else if (o == olds.size() || shape_less(*sorted_new[n], *olds[o])) {
      change.added.push_back(sorted_new[n++]->box);
    } else {
      ++o;
      ++n;
    }
  }
  return change;
}

}  // namespace swarm::planner
