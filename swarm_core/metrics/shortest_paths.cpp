// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/metrics/shortest_paths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

namespace swarm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Largest distance between an arc and its chord; coarser only in worlds with very many corners.
constexpr double kSagitta_m = 1e-3;

/// A path enters an obstacle if it is deeper inside than this, so paths along a wall are allowed.
constexpr double kSkin_m = 1e-7;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Appends points of the arc around `center` from angle `from` over `sweep` ≥ 0, both ends
/// included.
void add_arc(std::vector<Vec2>& out, const Vec2& center, double radius, double from, double sweep,
             double sagitta) {
  const double step = 2.0 * std::acos(1.0 - std::min(sagitta / radius, 0.5));
  const int chords = std::max(1, static_cast<int>(std::ceil(sweep / step)));
  for (int k = 0; k <= chords; ++k) {
    const double angle = from + sweep * k / chords;
    out.push_back(center + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
}

/// The outline of a convex obstacle grown by `by` (its Minkowski sum with a disc): edges move
/// outwards and every corner becomes an arc. The chords lie inside the arcs, so the outline is
/// never too large.
std::vector<Vec2> grown(const ConvexObstacle& obstacle, double by, double sagitta) {
  std::vector<Vec2> out;
  const std::vector<Vec2>& corners = obstacle.vertices_m;
  if (corners.empty()) {
    add_arc(out, obstacle.circle.center_m, obstacle.circle.radius_m + by, 0.0,
            2.0 * std::numbers::pi, sagitta);
    out.pop_back();  // the last point is the first
    return out;
  }
  if (by <= kSkin_m) return corners;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 in = corners[i] - corners[(i + n - 1) % n];
    const Vec2 on = corners[(i + 1) % n] - corners[i];
    const double from = std::atan2(-in.x(), in.y());  // angle of the incoming edge's outer normal
    const double sweep = std::max(0.0, std::atan2(cross(in, on), in.dot(on)));
    add_arc(out, corners[i], by, from, sweep, sagitta);
  }
  return out;
}

Box box_around(std::span<const Vec2> points) {
  Box box{.min_m = points[0], .max_m = points[0]};
  for (const Vec2& p : points) {
    box.min_m = box.min_m.cwiseMin(p);
    box.max_m = box.max_m.cwiseMax(p);
  }
  return box;
}

/// Distance of p beyond the line a→b of a counter-clockwise outline; positive outside.
double outside(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 edge = b - a;
  return cross(p - a, edge) / edge.norm();
}

/// Deeper inside than the skin: a point on the outline counts as outside.
bool strictly_inside(const Vec2& p, std::span<const Vec2> outline) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (outside(p, outline[i], outline[(i + 1) % outline.size()]) > -kSkin_m) return false;
  }
  return true;
}

/// Whether the segment enters the interior (Cyrus–Beck against every edge, moved inwards by the
/// skin).
bool enters(const Vec2& from, const Vec2& to, std::span<const Vec2> outline) {
  double first = 0.0;
  double last = 1.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2& a = outline[i];
    const Vec2& b = outline[(i + 1) % outline.size()];
    const double at_from = outside(from, a, b) + kSkin_m;
    const double at_to = outside(to, a, b) + kSkin_m;
    if (at_from >= 0.0 && at_to >= 0.0) return false;
    if (at_from > 0.0) first = std::max(first, at_from / (at_from - at_to));
    if (at_to > 0.0) last = std::min(last, at_from / (at_from - at_to));
    if (first >= last) return false;
  }
  return true;
}

/// Whether a shortest path through `p` may turn at this corner: the line from p only touches the
/// part.
bool touches(const Vec2& p, const Vec2& at, const Vec2& before, const Vec2& after) {
  const Vec2 line = at - p;
  const double slack = 1e-9 * line.norm();
  const double side_before = cross(line, before - at);
  const double side_after = cross(line, after - at);
  return (side_before >= -slack && side_after >= -slack) ||
         (side_before <= slack && side_after <= slack);
}

}  // namespace

/// Builds the visibility graph: vertices are the corners of the grown obstacles, edges join corners
/// that see each other and at both of which a shortest path may turn. O(V² · parts) time.
ShortestPaths::ShortestPaths(const World& world, double robot_radius_m)
    : bounds_m_(world.bounds_m()) {
  std::vector<const ConvexObstacle*> obstacles;
  for (const ConvexObstacle& obstacle : world.convex_obstacles()) obstacles.push_back(&obstacle);
  // Large obstacles come first, so that the small ones are left out where there are too many
  // corners.
  const auto size = [](const ConvexObstacle* o) { return (o->box.max_m - o->box.min_m).norm(); };
  std::stable_sort(obstacles.begin(), obstacles.end(),
                   [&](const auto* a, const auto* b) { return size(a) > size(b); });
  // Coarser arcs first; once a corner is a single chord, only fewer obstacles help.
  for (double sagitta = kSagitta_m;; sagitta *= 4.0) {
    parts_.clear();
    std::size_t vertices = 0;
    const bool coarsest = sagitta > robot_radius_m;
    for (const ConvexObstacle* obstacle : obstacles) {
      std::vector<Vec2> outline = grown(*obstacle, robot_radius_m, sagitta);
      vertices += outline.size();
      if (vertices > kMaxVertices) break;
      const Box box = box_around(outline);
      parts_.push_back({std::move(outline), box});
    }
    if (vertices <= kMaxVertices || coarsest) break;
  }
  for (const Part& part : parts_) {
    const std::size_t n = part.vertices_m.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2& at = part.vertices_m[i];
      // Robots stay inside the bounds, so no path turns outside or inside another grown obstacle.
      if (!bounds_m_.contains(at) || !parts_around(at).empty()) continue;
      vertices_.push_back({at, part.vertices_m[(i + n - 1) % n], part.vertices_m[(i + 1) % n]});
    }
  }
  // edges_from() checks tangency at the far end of an edge only; the near end is checked here.
  for (const Vertex& vertex : vertices_) {
    std::vector<Edge> edges = edges_from(vertex.at_m, {});
    std::erase_if(edges, [&](const Edge& edge) {
      return edge.length_m == 0.0 ||
             !touches(vertices_[edge.to].at_m, vertex.at_m, vertex.before_m, vertex.after_m);
    });
    graph_.push_back(std::move(edges));
  }
}

/// The grown obstacles around a point; more than one where they overlap.
std::vector<std::uint32_t> ShortestPaths::parts_around(const Vec2& p) const {
  std::vector<std::uint32_t> around;
  for (std::uint32_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].box.contains(p) && strictly_inside(p, parts_[i].vertices_m)) around.push_back(i);
  }
  return around;
}

/// `ignored` are the parts that contain an end of the path: the robot may leave them freely.
bool ShortestPaths::blocks(std::uint32_t part, const Vec2& a, const Vec2& b,
                           std::span<const std::uint32_t> ignored) const {
  const Box& box = parts_[part].box;
  if ((a.cwiseMin(b).array() > box.max_m.array()).any() ||
      (a.cwiseMax(b).array() < box.min_m.array()).any() ||
      std::find(ignored.begin(), ignored.end(), part) != ignored.end()) {
    return false;
  }
  return enters(a, b, parts_[part].vertices_m);
}

bool ShortestPaths::visible(const Vec2& a, const Vec2& b, std::span<const std::uint32_t> ignored,
                            std::uint32_t& last_blocker) const {
  // The part that hid the previous point of an outline mostly hides the next one too.
  if (last_blocker < parts_.size() && blocks(last_blocker, a, b, ignored)) return false;
  for (std::uint32_t i = 0; i < parts_.size(); ++i) {
    if (!blocks(i, a, b, ignored)) continue;
    last_blocker = i;
    return false;
  }
  return true;
}

/// All graph vertices to which a shortest path may lead from p in a straight line.
std::vector<ShortestPaths::Edge> ShortestPaths::edges_from(
    const Vec2& p, std::span<const std::uint32_t> ignored) const {
  std::vector<Edge> edges;
  std::uint32_t blocker = 0;
  for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
    const Vertex& vertex = vertices_[v];
    if (!touches(p, vertex.at_m, vertex.before_m, vertex.after_m)) continue;
    if (!visible(p, vertex.at_m, ignored, blocker)) continue;
    edges.push_back({v, (vertex.at_m - p).norm()});
  }
  return edges;
}

/// Dijkstra from a point whose first edges are given. Outdated queue entries are skipped when they
/// are popped instead of being decreased in place.
std::vector<double> ShortestPaths::distances_to_vertices(std::span<const Edge> first) const {
  std::vector<double> distances(vertices_.size(), kInfinity);
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto relax = [&](std::span<const Edge> edges, double base) {
    for (const auto& [to, length] : edges) {
      if (base + length >= distances[to]) continue;
      distances[to] = base + length;
      queue.emplace(distances[to], to);
    }
  };
  relax(first, 0.0);
  while (!queue.empty()) {
    const auto [distance, vertex] = queue.top();
    queue.pop();
    if (distance == distances[vertex]) relax(graph_[vertex], distance);
  }
  return distances;
}

/// One Dijkstra search for each start. Targets are not vertices of the graph: their edges are added
/// afterwards. A target that the start sees is at the straight distance.
std::vector<double> ShortestPaths::distances_m(std::span<const Vec2> from,
                                               std::span<const Vec2> to) const {
  std::vector<std::vector<std::uint32_t>> around_to;
  std::vector<std::vector<Edge>> last;
  for (const Vec2& p : to) {
    around_to.push_back(parts_around(p));
    last.push_back(edges_from(p, around_to.back()));
  }
  std::vector<double> distances;
  distances.reserve(from.size() * to.size());
  for (const Vec2& p : from) {
    const std::vector<std::uint32_t> around = parts_around(p);
    std::uint32_t blocker = 0;
    const std::vector<double> by_vertex = distances_to_vertices(edges_from(p, around));
    for (std::size_t j = 0; j < to.size(); ++j) {
      std::vector<std::uint32_t> ignored = around;
      ignored.insert(ignored.end(), around_to[j].begin(), around_to[j].end());
      if (visible(p, to[j], ignored, blocker)) {
        distances.push_back((to[j] - p).norm());
        continue;
      }
      double best = kInfinity;
      for (const auto& [vertex, length] : last[j]) {
        best = std::min(best, by_vertex[vertex] + length);
      }
      distances.push_back(best);
    }
  }
  return distances;
}

}  // namespace swarm
