// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/clearance.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "swarm_core/base/assert.hpp"
#include "swarm_monitor/audit/pair_grid.hpp"

namespace swarm::monitor {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Index of the last point at or before `time_s`. O(log points). \pre points[0].time_s <= time_s
std::size_t point_before(const Track& track, double time_s) {
  const auto after = std::upper_bound(track.points.begin(), track.points.end(), time_s,
                                      [](double t, const TrackPoint& p) { return t < p.time_s; });
  return static_cast<std::size_t>(after - track.points.begin()) - 1;
}

/// Position on one track at times that only ascend: each point is passed once, so a sweep over a
/// track is O(points).
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
  // Linear interpolation between the two points around `time_s`; after the last point the body
  // stays there.
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

/// The last window holds all that comes later: the stamp of a damaged record may lie years ahead,
/// and a window per second would exhaust the memory. 200 000 windows are 55 h.
constexpr std::size_t kLastWindow = 200'000;

std::size_t window_of(double time_s) {
  return std::min(kLastWindow, static_cast<std::size_t>(time_s / Clearance::kWindow_s));
}

/// Time until which a body is present: its last step, or later if its robot died there. \pre some
/// point
double end_of(const Track& track) {
  return std::max(track.points.back().time_s, track.body_until_s);
}

/// Number of windows of kWindow_s that cover all tracks, bodies of dead robots included.
std::size_t windows_of(std::span<const Track> tracks) {
  double end_s = 0.0;
  for (const Track& track : tracks) {
    if (!track.points.empty()) end_s = std::max(end_s, end_of(track));
  }
  return window_of(end_s) + 1;
}

/// A clearance without any approach: every window and robot at the cap, which later approaches can
/// only lower.
Clearance empty_clearance(std::span<const Track> tracks) {
  Clearance clearance;
  clearance.by_window_m.assign(windows_of(tracks), Clearance::kCap_m);
  clearance.by_robot_m.assign(tracks.size(), Clearance::kCap_m);
  return clearance;
}

/// Collects the deepest approach of every pair that touches, so that a contact that lasts over
/// several windows is one contact.
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

/// Bounding box of a track in a window, with the points just outside the window at both ends, since
/// the motion between points is straight. Empty if the body is not present in the window.
std::optional<Box> box_of(const Track& track, double from_s, double to_s) {
  if (track.points.empty() || track.points.front().time_s > to_s || end_of(track) < from_s) {
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

/// Gaps of all pairs that come within `search_m`, window by window: boxes of one second of motion,
/// a grid as the broad phase, then the exact nearest approach of each candidate pair. For robots
/// that keep their distance the cost is O(steps + near pairs).
Clearance robot_clearance_within(std::span<const Track> tracks, double search_m) {
  Clearance clearance = empty_clearance(tracks);
  Contacts contacts, fallen;
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
    // Cells of the search radius, but not under 2 m: smaller cells would enter a box of one second
    // of motion into many cells.
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
      approach = fallen_approach_of(tracks[i], tracks[j], from_s, to_s);
      approach.robot = i;
      approach.other = j;
      fallen.add(approach);
    });
  }
  clearance.contacts = contacts.take();
  clearance.fallen_contacts = fallen.take();
  return clearance;
}

/// Nearest approach of two bodies in a time in which both are present. Merges the points of both
/// tracks, so that both move straight in every piece. O(points of both). \pre from_s ≤ to_s, points
/// in both
Approach nearest_within(const Track& a, const Track& b, double from_s, double to_s) {
  Approach nearest;
  Cursor at_a(a, from_s);
  Cursor at_b(b, from_s);
  for (double t0 = from_s;;) {
    at_a.step_to(t0);
    at_b.step_to(t0);
    const double t1 = std::min({at_a.next_s(), at_b.next_s(), to_s});
    // Both move straight in [t0, t1], so the relative position is a segment d + u·(d′ − d), and its
    // point nearest to the origin has u = −d·(d′ − d)/‖d′ − d‖², clamped to [0, 1].
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

/// A phase of the map (the time between two changes of the scene) on the time axis of the tracks.
struct PhaseSpan {
  const World& world;
  double begin_s;
  double end_s;
  double fastest_mps;  // obstacle
};

/// Adds the approaches of one robot to all obstacles of a phase. O(points · obstacles) at worst;
/// robots in open space skip most points, see idle_m.
void add_obstacle_approaches(std::uint32_t robot, const Track& track, const PhaseSpan& phase,
                             Clearance& clearance, Contacts& contacts) {
  const auto& points = track.points;
  const auto later = std::upper_bound(points.begin(), points.end(), phase.begin_s,
                                      [](double t, const TrackPoint& p) { return t < p.time_s; });
  // Distance that robot and obstacles together may still travel before any gap can fall below the
  // reach: until it is used up, no obstacle is looked at. This is conservative, because the gap
  // shrinks by at most the robot's path plus the path of the fastest obstacle.
  double idle_m = 0.0;
  const auto passed = static_cast<std::size_t>(later - points.begin());
  for (std::size_t k = passed - std::min<std::size_t>(passed, 1);
       k < points.size() && points[k].time_s < phase.end_s; ++k) {
    // The last point is a piece of length 0: a track of one point has a gap, too.
    const std::size_t next = std::min(k + 1, points.size() - 1);
    const double from_s = std::max(points[k].time_s, phase.begin_s);
    const double to_s = std::min(points[next].time_s, phase.end_s);
    if (from_s > to_s) continue;
    const double duration_s = points[next].time_s - points[k].time_s;
    const auto place_at = [&](double t) -> Vec2 {
      const double share = duration_s > 0.0 ? (t - points[k].time_s) / duration_s : 0.0;
      return points[k].position_m + share * (points[next].position_m - points[k].position_m);
    };
    const Vec2 from = place_at(from_s);
    const Vec2 to = place_at(to_s);
    // Upper bound of how much the gap to any obstacle can shrink within this piece.
    const double path_m = (to - from).norm() + phase.fastest_mps * (to_s - from_s);
    const double reach_m = std::max(Clearance::kCap_m, clearance.nearest.gap_m);
    idle_m -= path_m;
    if (idle_m > 0.0) continue;
    const double moved_m = phase.fastest_mps * (from_s - phase.begin_s);
    idle_m = phase.world.distance_m(from) - moved_m - track.radius_m - reach_m - path_m;
    if (idle_m > 0.0) continue;
    const std::size_t window = window_of(points[k].time_s);
    for (const ConvexObstacle& obstacle : phase.world.convex_obstacles()) {
      // In the frame of the obstacle, which then stays where it is at the begin of the phase, while
      // the robot moves straight at the relative velocity.
      const Vec2 from_m = from - (from_s - phase.begin_s) * obstacle.velocity_mps;
      const Vec2 to_m = to - (to_s - phase.begin_s) * obstacle.velocity_mps;
      // A lower bound of the gap by the obstacle's box is cheap and rejects most obstacles before
      // the golden section.
      const double at_least =
          obstacle.box.distance_m(from_m) - (to_m - from_m).norm() - track.radius_m;
      if (at_least >= reach_m) continue;
      const auto [gap, share] = approach_of(from_m, to_m, track.radius_m, obstacle);
      const Approach approach{.gap_m = gap,
                              .time_s = from_s + share * (to_s - from_s),
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

/// The overlap of the two tracks in time, cut to the window.
Approach approach_of(const Track& a, const Track& b, double from_s, double to_s) {
  if (a.points.empty() || b.points.empty()) return {};
  from_s = std::max({from_s, a.points.front().time_s, b.points.front().time_s});
  to_s = std::min({to_s, a.points.back().time_s, b.points.back().time_s});
  return from_s > to_s ? Approach{} : nearest_within(a, b, from_s, to_s);
}

/// From the moment when the first of the two ended: until then the pair is one of living robots.
Approach fallen_approach_of(const Track& a, const Track& b, double from_s, double to_s) {
  if (a.points.empty() || b.points.empty()) return {};
  const double one_fell_s = std::min(a.points.back().time_s, b.points.back().time_s);
  from_s = std::max({from_s, a.points.front().time_s, b.points.front().time_s, one_fell_s});
  to_s = std::min({to_s, end_of(a), end_of(b)});
  return from_s >= to_s ? Approach{} : nearest_within(a, b, from_s, to_s);
}

/// Golden section search: each step keeps one of the two inner values and shrinks the interval by
/// 0.618, so 1e-9 m of a 1 m piece take 43 evaluations of the signed distance.
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
  // The search ends inside the interval; the ends are compared as well, since the minimum of a
  // convex function on a segment is often at one.
  std::pair<double, double> best{gap_at(0.0), 0.0};
  for (const double share : {x, y, 1.0}) {
    if (const double gap = gap_at(share); gap < best.first) best = {gap, share};
  }
  return best;
}

Clearance robot_clearance(std::span<const Track> tracks) {
  // Extent of all positions: no two robots are farther apart than its diagonal, so a wider search
  // cannot find a new pair.
  Box all{Vec2::Constant(kInfinity), Vec2::Constant(-kInfinity)};
  for (const Track& track : tracks) {
    for (const TrackPoint& point : track.points) {
      all.min_m = all.min_m.cwiseMin(point.position_m);
      all.max_m = all.max_m.cwiseMax(point.position_m);
    }
  }
  // Four times the radius in each round: few rounds for swarms that keep far apart, and one round
  // for all others.
  for (double search_m = Clearance::kCap_m;; search_m *= 4.0) {
    Clearance clearance = robot_clearance_within(tracks, search_m);
    if (clearance.nearest.gap_m <= search_m || !((all.max_m - all.min_m).norm() > search_m)) {
      return clearance;
    }
  }
}

/// Phase by phase, because the obstacles of a phase move evenly only within it. O(phases · robots ·
/// points · obstacles) at worst.
Clearance obstacle_clearance(std::span<const Track> tracks, std::span<const WorldPhase> phases,
                             UtcTime begin) {
  SWARM_ASSERT(!phases.empty());
  Clearance clearance = empty_clearance(tracks);
  Contacts contacts;
  for (std::size_t p = 0; p < phases.size(); ++p) {
    const World& world = phases[p].world;
    if (world.convex_obstacles().empty()) continue;
    double fastest_mps = 0.0;
    for (const ConvexObstacle& obstacle : world.convex_obstacles()) {
      fastest_mps = std::max(fastest_mps, obstacle.velocity_mps.norm());
    }
    // Tracks begin at 0: the first phase, from the beginning of time, begins there for them.
    const PhaseSpan span{
        world, std::max(0.0, to_seconds(phases[p].begin - begin)),
        p + 1 < phases.size() ? to_seconds(phases[p + 1].begin - begin) : kInfinity, fastest_mps};
    for (std::uint32_t i = 0; i < tracks.size(); ++i) {
      add_obstacle_approaches(i, tracks[i], span, clearance, contacts);
    }
  }
  clearance.contacts = contacts.take();
  return clearance;
}

}  // namespace swarm::monitor
