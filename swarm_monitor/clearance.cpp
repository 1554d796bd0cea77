// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/clearance.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "swarm_monitor/pair_grid.hpp"

namespace swarm::monitor {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Index of the last point at or before `time_s`. \pre points[0].time_s <= time_s
std::size_t point_before(const Track& track, double time_s) {
  const auto after = std::upper_bound(track.points.begin(), track.points.end(), time_s,
                                      [](double t, const TrackPoint& p) { return t < p.time_s; });
  return static_cast<std::size_t>(after - track.points.begin()) - 1;
}

/// Walks along one track.
class Cursor {
 public:
  Cursor(const Track& track, double time_s) : track_(track), i_(point_before(track, time_s)) {}

  /// Time of the next point, +∞ at the end.
  double next_s() const {
    return i_ + 1 < track_.points.size() ? track_.points[i_ + 1].time_s : kInfinity;
  }
  void step_to(double time_s) {
    while (next_s() <= time_s) ++i_;
  }
  Vec2 at(double time_s) const {
    const TrackPoint& a = track_.points[i_];
    if (i_ + 1 == track_.points.size()) return a.position_m;
    const TrackPoint& b = track_.points[i_ + 1];
    const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
    return a.position_m + share * (b.position_m - a.position_m);
  }

 private:
  const Track& track_;
  std::size_t i_;
};

/// The last window holds all that comes later: a stamp far off must not fill the memory.
constexpr std::size_t kLastWindow = 200'000;

std::size_t window_of(double time_s) {
  return std::min(kLastWindow, static_cast<std::size_t>(time_s / Clearance::kWindow_s));
}

std::size_t windows_of(std::span<const Track> tracks) {
  double end_s = 0.0;
  for (const Track& track : tracks) {
    if (!track.points.empty()) end_s = std::max(end_s, track.points.back().time_s);
  }
  return window_of(end_s) + 1;
}

Clearance empty_clearance(std::span<const Track> tracks) {
  Clearance clearance;
  clearance.by_window_m.assign(windows_of(tracks), Clearance::kCap_m);
  clearance.by_robot_m.assign(tracks.size(), Clearance::kCap_m);
  return clearance;
}

/// Collects the deepest approach of every pair that touches.
class Contacts {
 public:
  void add(const Approach& approach) {
    if (approach.gap_m > 0.0) return;
    const auto [it, is_new] = deepest_.try_emplace({approach.robot, approach.other}, approach);
    if (!is_new && approach.gap_m < it->second.gap_m) it->second = approach;
  }
  std::vector<Approach> take() const {
    std::vector<Approach> all;
    for (const auto& [pair, approach] : deepest_) all.push_back(approach);
    return all;
  }

 private:
  std::map<std::pair<std::uint32_t, std::uint32_t>, Approach> deepest_;
};

/// Box around everything a track does in a window, a little more at its ends.
std::optional<Box> box_of(const Track& track, double from_s, double to_s) {
  if (track.points.empty() || track.points.front().time_s > to_s ||
      track.points.back().time_s < from_s) {
    return std::nullopt;
  }
  std::size_t i = track.points.front().time_s > from_s ? 0 : point_before(track, from_s);
  Box box{track.points[i].position_m, track.points[i].position_m};
  for (; i < track.points.size(); ++i) {
    box.min_m = box.min_m.cwiseMin(track.points[i].position_m);
    box.max_m = box.max_m.cwiseMax(track.points[i].position_m);
    if (track.points[i].time_s >= to_s) break;
  }
  return box;
}

Clearance robot_clearance_within(std::span<const Track> tracks, double search_m) {
  Clearance clearance = empty_clearance(tracks);
  Contacts contacts;
  std::vector<PairGrid::Item> items;
  for (std::size_t window = 0; window < clearance.by_window_m.size(); ++window) {
    const double from_s = static_cast<double>(window) * Clearance::kWindow_s;
    const double to_s = window == kLastWindow ? kInfinity : from_s + Clearance::kWindow_s;
    items.clear();
    for (std::uint32_t i = 0; i < tracks.size(); ++i) {
      auto box = box_of(tracks[i], from_s, to_s);
      if (!box) continue;
      // Two robots with a gap of search_m have boxes that overlap once each grows by its share.
      const Vec2 margin = Vec2::Constant(0.5 * search_m + tracks[i].radius_m);
      items.push_back({i, {box->min_m - margin, box->max_m + margin}});
    }
    PairGrid(items, std::max(2.0, search_m)).for_each_pair([&](std::uint32_t i, std::uint32_t j) {
      Approach approach = approach_of(tracks[i], tracks[j], from_s, to_s);
      approach.robot = i;
      approach.other = j;
      if (approach.gap_m < clearance.nearest.gap_m) clearance.nearest = approach;
      for (double* least :
           {&clearance.by_window_m[window], &clearance.by_robot_m[i], &clearance.by_robot_m[j]}) {
        *least = std::min(*least, approach.gap_m);
      }
      contacts.add(approach);
    });
  }
  clearance.contacts = contacts.take();
  return clearance;
}

/// Adds one robot's motion past all obstacles.
void add_obstacle_approaches(std::uint32_t robot, const Track& track, const World& world,
                             Clearance& clearance, Contacts& contacts) {
  // How far the robot may still go before any gap can be of interest.
  double idle_m = 0.0;
  for (std::size_t k = 0; k < track.points.size(); ++k) {
    const Vec2& from = track.points[k].position_m;
    // The last point is a piece of length 0: a track of one point has a gap, too.
    const Vec2& to = track.points[std::min(k + 1, track.points.size() - 1)].position_m;
    const double length = (to - from).norm();
    const double reach_m = std::max(Clearance::kCap_m, clearance.nearest.gap_m);
    idle_m -= length;
    if (idle_m > 0.0) continue;
    idle_m = world.distance_m(from) - track.radius_m - reach_m - length;
    if (idle_m > 0.0) continue;
    const std::size_t window = window_of(track.points[k].time_s);
    for (const ConvexObstacle& obstacle : world.convex_obstacles()) {
      const double at_least = obstacle.box.distance_m(from) - length - track.radius_m;
      if (at_least >= reach_m) continue;
      const auto [gap, share] = approach_of(from, to, track.radius_m, obstacle);
      const double next_s = track.points[std::min(k + 1, track.points.size() - 1)].time_s;
      const Approach approach{
          .gap_m = gap,
          .time_s = track.points[k].time_s + share * (next_s - track.points[k].time_s),
          .at_m = from + share * (to - from),
          .robot = robot,
          .other = static_cast<std::uint32_t>(obstacle.obstacle)};
      if (gap < clearance.nearest.gap_m) clearance.nearest = approach;
      clearance.by_window_m[window] = std::min(clearance.by_window_m[window], gap);
      clearance.by_robot_m[robot] = std::min(clearance.by_robot_m[robot], gap);
      contacts.add(approach);
    }
  }
}

}  // namespace

Approach approach_of(const Track& a, const Track& b, double from_s, double to_s) {
  Approach nearest;
  if (a.points.empty() || b.points.empty()) return nearest;
  from_s = std::max({from_s, a.points.front().time_s, b.points.front().time_s});
  to_s = std::min({to_s, a.points.back().time_s, b.points.back().time_s});
  if (from_s > to_s) return nearest;
  Cursor at_a(a, from_s);
  Cursor at_b(b, from_s);
  for (double t0 = from_s;;) {
    at_a.step_to(t0);
    at_b.step_to(t0);
    const double t1 = std::min({at_a.next_s(), at_b.next_s(), to_s});
    // Both move straight in [t0, t1]: the distance is that of a segment to the origin.
    const Vec2 start_a = at_a.at(t0);
    const Vec2 apart = start_a - at_b.at(t0);
    const Vec2 change = at_a.at(t1) - at_b.at(t1) - apart;
    const double change_squared = change.squaredNorm();
    const double share =
        change_squared > 0.0 ? std::clamp(-apart.dot(change) / change_squared, 0.0, 1.0) : 0.0;
    const double gap = (apart + share * change).norm() - a.radius_m - b.radius_m;
    if (gap < nearest.gap_m) {
      const double time_s = t0 + share * (t1 - t0);
      nearest = {.gap_m = gap, .time_s = time_s, .at_m = at_a.at(time_s)};
    }
    if (t1 >= to_s) return nearest;
    t0 = t1;
  }
}

std::pair<double, double> approach_of(const Vec2& from_m, const Vec2& to_m, double radius_m,
                                      const ConvexObstacle& obstacle) {
  constexpr double kTolerance_m = 1e-9;
  constexpr double kGolden = 0.6180339887498949;
  const auto gap_at = [&](double share) {
    return obstacle.signed_distance(from_m + share * (to_m - from_m)).distance_m - radius_m;
  };
  const double length = (to_m - from_m).norm();
  double low = 0.0, high = 1.0;
  double x = high - kGolden, y = low + kGolden;
  double gap_x = gap_at(x), gap_y = gap_at(y);
  while ((high - low) * length > kTolerance_m) {
    if (gap_x <= gap_y) {
      high = y;
      y = std::exchange(x, y - kGolden * (y - low));
      gap_y = std::exchange(gap_x, gap_at(x));
    } else {
      low = x;
      x = std::exchange(y, x + kGolden * (high - x));
      gap_x = std::exchange(gap_y, gap_at(y));
    }
  }
  std::pair<double, double> best{gap_at(0.0), 0.0};
  for (const double share : {x, y, 1.0}) {
    if (const double gap = gap_at(share); gap < best.first) best = {gap, share};
  }
  return best;
}

Clearance robot_clearance(std::span<const Track> tracks) {
  // Beyond this nothing is farther apart, so a wider search finds nothing new.
  Box all{Vec2::Constant(kInfinity), Vec2::Constant(-kInfinity)};
  for (const Track& track : tracks) {
    for (const TrackPoint& point : track.points) {
      all.min_m = all.min_m.cwiseMin(point.position_m);
      all.max_m = all.max_m.cwiseMax(point.position_m);
    }
  }
  for (double search_m = Clearance::kCap_m;; search_m *= 4.0) {
    Clearance clearance = robot_clearance_within(tracks, search_m);
    if (clearance.nearest.gap_m <= search_m || !((all.max_m - all.min_m).norm() > search_m)) {
      return clearance;
    }
  }
}

Clearance obstacle_clearance(std::span<const Track> tracks, const World& world) {
  Clearance clearance = empty_clearance(tracks);
  Contacts contacts;
  if (!world.convex_obstacles().empty()) {
    for (std::uint32_t i = 0; i < tracks.size(); ++i) {
      add_obstacle_approaches(i, tracks[i], world, clearance, contacts);
    }
  }
  clearance.contacts = contacts.take();
  return clearance;
}

}  // namespace swarm::monitor
