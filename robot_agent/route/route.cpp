// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/route.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "robot_agent/route/detour.hpp"
#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarm_core/plan/flow_draw.hpp"

namespace swarm::agent {
namespace {

/// A Gaussian that a robot passes, and its own point in it: y in docs/notation.md.
struct Station {
  Gaussian gaussian;
  double time_s = 0.0;
  Vec2 offset_m = Vec2::Zero();  // from the mean, as transported
};

/// Limits an offset to a Mahalanobis distance: a robot far from the Gaussian enters it at its edge.
Vec2 clamp_offset(const Gaussian& g, const Vec2& offset, double offset_max) {
  const double d = std::sqrt(g.mahalanobis_squared(g.mean_m() + offset));
  return d > offset_max ? Vec2(offset * (offset_max / d)) : offset;
}

/// Follows the flow from a node to a sink, drawing a leg at every split.
std::uint32_t follow(const FlowPlan& plan, std::uint32_t node, double share,
                     std::vector<Station>& stations) {
  for (;;) {
    if (plan.legs_out(node).empty()) return node;
    const std::uint32_t next = plan.legs()[draw_leg(plan, node, share)].to;
    const PlanNode& to = plan.nodes()[next];
    const Station& last = stations.back();
    stations.push_back(
        {to.gaussian, to.time.count(), transport_map(last.gaussian, to.gaussian) * last.offset_m});
    node = next;
  }
}

/// The robot's point in each station. An offset whose point is too near to an obstacle shrinks
/// towards the mean by bisection; then both ends of each leg that is not free shrink, in the last
/// two passes down to the means.
std::vector<Vec2> free_vertices(const std::vector<Station>& stations, const World& world,
                                const RouteOptions& options) {
  const Box inside{world.bounds_m().min_m.array() + options.radius_m,
                   world.bounds_m().max_m.array() - options.radius_m};
  const auto vertex = [&](std::size_t i, double scale) -> Vec2 {
    const Vec2 p = stations[i].gaussian.mean_m() + scale * stations[i].offset_m;
    return p.cwiseMax(inside.min_m).cwiseMin(inside.max_m);
  };
  std::vector<double> scale(stations.size(), 1.0);
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const double clearance = options.radius_m + options.vertex_clearance_m;
    if (world.distance_m(vertex(i, 1.0)) >= clearance) continue;
    double low = 0.0;
    double high = 1.0;
    for (int step = 0; step < 5; ++step) {
      const double mid = 0.5 * (low + high);
      (world.distance_m(vertex(i, mid)) >= clearance ? low : high) = mid;
    }
    scale[i] = low;
  }
  const double clearance = options.radius_m + options.leg_clearance_m;
  for (int pass = 0; pass < 8; ++pass) {
    bool all_free = true;
    for (std::size_t i = 0; i + 1 < stations.size(); ++i) {
      if (world.segment_is_free(vertex(i, scale[i]), vertex(i + 1, scale[i + 1]), clearance))
        continue;
      all_free = false;
      const double shrink = pass < 6 ? 0.6 : 0.0;
      scale[i] *= shrink;
      scale[i + 1] *= shrink;
    }
    if (all_free) break;
  }
  std::vector<Vec2> vertices;
  vertices.reserve(stations.size());
  for (std::size_t i = 0; i < stations.size(); ++i) vertices.push_back(vertex(i, scale[i]));
  return vertices;
}

/// The end of a path: beside the bodies and, where they leave room, inside the goal's 99 % ellipse,
/// since outside of it a robot would never have arrived. O(bodies).
Vec2 end_in_goal(const Gaussian& goal, const Vec2& own_m, const World& world,
                 const DetourOptions& detour) {
  const Vec2 beside_m = beside_bodies(own_m, world, detour);
  if (goal.contains_99(beside_m)) return beside_m;
  constexpr int kSteps = 10;
  for (int i = 1; i <= kSteps; ++i) {
    const Vec2 nearer_m = own_m + static_cast<double>(i) / kSteps * (goal.mean_m() - own_m);
    const Vec2 end_m = beside_bodies(nearer_m, world, detour);
    if (goal.contains_99(end_m) && world.is_clear(end_m, detour.radius_m)) return end_m;
  }
  return beside_m;
}

/// Completes the stations to a sink and turns them into path and schedule: each station's plan time
/// belongs to the arc length of its vertex, detours around bodies included.
Route finish(const FlowPlan& plan, std::uint32_t node, double share, std::vector<Station> stations,
             const World& world, const RouteOptions& options,
             std::optional<Vec2> begin_m = std::nullopt) {
  const std::uint32_t last = follow(plan, node, share, stations);
  const auto sink = std::find(plan.sinks().begin(), plan.sinks().end(), last);
  SWARM_ASSERT(sink != plan.sinks().end());
  // Bodies of dead robots are small against a plan: they bend single paths, but do not shrink
  // offsets.
  const std::vector<Vec2> own_m = free_vertices(stations, world.without_bodies(), options);
  const DetourOptions detour = detour_options(options);
  std::vector<Vec2> vertices;
  double at_m = 0.0;
  const auto go_to = [&](const Vec2& next_m) {
    if (!vertices.empty()) at_m += (next_m - vertices.back()).norm();
    vertices.push_back(next_m);
  };
  if (begin_m) go_to(*begin_m);
  std::vector<Schedule::Entry> schedule;
  schedule.reserve(stations.size());
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const Vec2 next_m = i + 1 < stations.size()
                            ? beside_bodies(own_m[i], world, detour)
                            : end_in_goal(stations[i].gaussian, own_m[i], world, detour);
    if (!vertices.empty()) {
      for (const Vec2& bend_m : around_bodies(vertices.back(), next_m, world, detour))
        go_to(bend_m);
    }
    go_to(next_m);
    schedule.push_back({stations[i].time_s, at_m});
  }
  return {.path = Polyline(std::move(vertices)),
          .schedule = Schedule(std::move(schedule)),
          .sink = static_cast<std::uint32_t>(sink - plan.sinks().begin()),
          .goal = plan.nodes()[last].gaussian};
}

}  // namespace

/// The source is drawn by the robot's share; the path begins at the robot's offset in it.
Route route_from_start(const FlowPlan& plan, double share, const Vec2& position_m,
                       const World& world, const RouteOptions& options) {
  const std::uint32_t node = plan.sources()[draw_source(plan, share)];
  const PlanNode& from = plan.nodes()[node];
  const Gaussian& g = from.gaussian;
  const Vec2 offset = clamp_offset(g, position_m - g.mean_m(), options.offset_max);
  return finish(plan, node, share, {{g, from.time.count(), offset}}, world, options);
}

/// The path begins at the robot and leads into the named source.
Route route_from_source(const FlowPlan& plan, std::uint32_t source, double share,
                        const Vec2& position_m, const World& world, const RouteOptions& options) {
  const std::uint32_t node = plan.sources()[source];
  const Gaussian& g = plan.nodes()[node].gaussian;
  const Vec2 offset = clamp_offset(g, position_m - g.mean_m(), options.offset_max);
  return finish(plan, node, share, {{g, plan.nodes()[node].time.count(), offset}}, world, options,
                position_m);
}

/// Enters at the Gaussian along any leg that is nearest in squared Mahalanobis distance plus
/// squared time difference in units of kJoin_s; one in line of sight goes before any other. O(17 ·
/// legs).
Route route_from_here(const FlowPlan& plan, double share, const Vec2& position_m,
                      const World& world, const RouteOptions& options,
                      std::optional<double> plan_time_s) {
  // Each node is then both source and sink.
  if (plan.legs().empty()) {
    const auto source = static_cast<std::uint32_t>(draw_source(plan, share));
    return route_from_source(plan, source, share, position_m, world, options);
  }
  constexpr int kPointsPerLeg = 16;
  double best = std::numeric_limits<double>::infinity();
  bool best_visible = false;
  std::uint32_t best_leg = 0;
  Station here;
  for (std::uint32_t l = 0; l < plan.legs().size(); ++l) {
    const PlanLeg& leg = plan.legs()[l];
    const PlanNode& from = plan.nodes()[leg.from];
    const PlanNode& to = plan.nodes()[leg.to];
    const Geodesic geodesic(from.gaussian, to.gaussian);
    for (int i = 0; i <= kPointsPerLeg; ++i) {
      const double along = static_cast<double>(i) / kPointsPerLeg;
      const Gaussian g = geodesic.at(along);
      const double time_s = (from.time + along * (to.time - from.time)).count();
      const double off_s = plan_time_s ? (time_s - *plan_time_s) / kJoin_s : 0.0;
      const double d = g.mahalanobis_squared(position_m) + off_s * off_s;
      // Lines of sight are costly: only candidates that can win are checked.
      if (best_visible && d >= best) continue;
      const bool visible = world.segment_is_free(position_m, g.mean_m(), options.radius_m);
      if ((visible && !best_visible) || (visible == best_visible && d < best)) {
        best = d;
        best_visible = visible;
        best_leg = l;
        here = {g, time_s};
      }
    }
  }
  here.offset_m =
      clamp_offset(here.gaussian, position_m - here.gaussian.mean_m(), options.offset_max);
  const std::uint32_t next = plan.legs()[best_leg].to;
  const PlanNode& to = plan.nodes()[next];
  const Station after{to.gaussian, to.time.count(),
                      transport_map(here.gaussian, to.gaussian) * here.offset_m};
  return finish(plan, next, share, {here, after}, world, options, position_m);
}

}  // namespace swarm::agent
