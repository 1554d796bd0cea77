// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/passage_times.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

namespace swarm::planner {
namespace {

constexpr double kTouching_m = 1e-6;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

// Where the segment from a to b, as a fraction 0 to 1, crosses the passage; nothing if it does not.
std::optional<double> crossing(const Vec2& a_m, const Vec2& b_m, const Passage& passage) {
  const Vec2 path_m = b_m - a_m;
  const Vec2 gate_m = passage.to_m - passage.from_m;
  const double turn = cross(path_m, gate_m);
  if (turn == 0.0) return std::nullopt;
  const double along = cross(passage.from_m - a_m, gate_m) / turn;
  const double across = cross(passage.from_m - a_m, path_m) / turn;
  // A leg that ends on the passage has crossed it, one that begins there has not: a route with a
  // waypoint there counts once.
  if (along <= 0.0 || along > 1.0 || across < 0.0 || across > 1.0) return std::nullopt;
  return along;
}

// The shortest segment that begins at a corner (or on the circle) of `a` and ends on `b`.
Passage shortest_from(const ConvexObstacle& a, const ConvexObstacle& b) {
  Passage shortest{Vec2::Zero(), Vec2::Constant(std::numeric_limits<double>::infinity())};
  const auto try_from = [&](const Vec2& p_m, double radius_m) {
    const SignedDistance to_b = b.signed_distance(p_m);
    const Passage found{p_m - radius_m * to_b.gradient, p_m - to_b.distance_m * to_b.gradient};
    if (to_b.distance_m > radius_m && found.width_m() < shortest.width_m()) shortest = found;
  };
  if (a.vertices_m.empty()) try_from(a.circle.center_m, a.circle.radius_m);
  for (const Vec2& vertex_m : a.vertices_m) try_from(vertex_m, 0.0);
  return shortest;
}

// The shortest segment between two convex shapes ends at a corner of one of them (or on a circle).
Passage between(const ConvexObstacle& a, const ConvexObstacle& b) {
  const Passage there = shortest_from(a, b);
  const Passage back = shortest_from(b, a);
  return there.width_m() <= back.width_m() ? there : back;
}

// Whether the mean of any leg crosses a passage.
bool is_crossed(const FlowPlan& plan, const Passage& passage) {
  return std::any_of(plan.legs().begin(), plan.legs().end(), [&](const PlanLeg& leg) {
    return crossing(plan.nodes()[leg.from].gaussian.mean_m(),
                    plan.nodes()[leg.to].gaussian.mean_m(), passage)
        .has_value();
  });
}

// Times of an event, each with the mass it happens to: first, last, and when half of the mass is
// done.
class Times {
 public:
  void add(MissionTime time, double mass) {
    if (mass > 0.0) times_.emplace_back(time, mass);
  }
  std::optional<GroupTimes::Span> span() {
    if (times_.empty()) return std::nullopt;
    std::sort(times_.begin(), times_.end());
    double all = 0.0;
    for (const auto& [time, mass] : times_) all += mass;
    GroupTimes::Span span{times_.front().first, times_.back().first, times_.back().first};
    double through = 0.0;
    for (const auto& [time, mass] : times_) {
      through += mass;
      if (through < 0.5 * all) continue;
      span.half = time;
      break;
    }
    return span;
  }

 private:
  std::vector<std::pair<MissionTime, double>> times_;
};

// The mass of one source, followed along the legs. At a node it mixes with other mass and leaves by
// each leg in proportion.
class Group {
 public:
  Group(const FlowPlan& plan, std::uint32_t source) : plan_(plan), mass_(plan.nodes().size(), 0.0) {
    mass_[source] = plan.nodes()[source].mass;
    start_m_ = plan.nodes()[source].gaussian.mean_m();
    for (const std::uint32_t sink : plan.sinks()) {
      goals_m_.push_back(plan.nodes()[sink].gaussian.mean_m());
    }
  }

  // Legs have to come in order of time, so that the mass of a node is complete before it leaves.
  GroupTimes times(const std::vector<std::uint32_t>& legs_in_time,
                   const std::optional<Passage>& passage, double speed_mps) {
    GroupTimes result;
    Times leaves;
    Times passes;
    Times arrives;
    for (const double mass : mass_) result.share += mass;
    for (const std::uint32_t l : legs_in_time) {
      const PlanLeg& leg = plan_.legs()[l];
      const PlanNode& from = plan_.nodes()[leg.from];
      const PlanNode& to = plan_.nodes()[leg.to];
      const double mass = leg.mass * mass_[leg.from] / from.mass;
      mass_[leg.to] += mass;
      const Vec2& from_m = from.gaussian.mean_m();
      const Vec2& to_m = to.gaussian.mean_m();
      const bool moves = from_m != to_m;
      if (moves && from_m == start_m_) leaves.add(from.time, mass);
      if (moves && is_goal(to_m)) arrives.add(to.time, mass);
      if (moves || !is_goal(to_m)) {
        const MissionTime path((to_m - from_m).norm() / speed_mps);
        result.waits_on_average += mass / result.share * (to.time - from.time - path);
      }
      if (!passage) continue;
      if (const auto along = crossing(from_m, to_m, *passage)) {
        passes.add(from.time + *along * (to.time - from.time), mass);
      }
    }
    result.leaves = leaves.span().value_or(GroupTimes::Span{});
    result.arrives = arrives.span().value_or(GroupTimes::Span{});
    result.passes = passes.span();
    return result;
  }

 private:
  bool is_goal(const Vec2& mean_m) const {
    return std::find(goals_m_.begin(), goals_m_.end(), mean_m) != goals_m_.end();
  }

  const FlowPlan& plan_;
  std::vector<double> mass_;  // of this group at each node
  Vec2 start_m_;
  std::vector<Vec2> goals_m_;
};

std::string to_text(const GroupTimes::Span& span) {
  return fmt::format("{:>6.1f} {:>6.1f} {:>6.1f}", span.first.count(), span.half.count(),
                     span.last.count());
}

}  // namespace

// Tests all pairs of convex parts. The distance of boxes and the best width so far rule out most.
std::optional<Passage> narrowest_passage(const FlowPlan& plan, const World& world) {
  const std::vector<ConvexObstacle>& parts = world.convex_obstacles();
  std::optional<Passage> narrowest;
  double width_m = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < parts.size(); ++a) {
    for (std::size_t b = a + 1; b < parts.size(); ++b) {
      if (parts[a].box.gap_squared_m2(parts[b].box) >= width_m * width_m) continue;
      const Passage passage = between(parts[a], parts[b]);
      if (!(passage.width_m() > kTouching_m && passage.width_m() < width_m)) continue;
      if (!is_crossed(plan, passage)) continue;
      width_m = passage.width_m();
      narrowest = passage;
    }
  }
  return narrowest;
}

std::vector<GroupTimes> group_times(const FlowPlan& plan, const std::optional<Passage>& passage,
                                    double speed_mps) {
  std::vector<std::uint32_t> legs(plan.legs().size());
  std::iota(legs.begin(), legs.end(), 0U);
  std::stable_sort(legs.begin(), legs.end(), [&](std::uint32_t a, std::uint32_t b) {
    return plan.nodes()[plan.legs()[a].from].time < plan.nodes()[plan.legs()[b].from].time;
  });
  std::vector<GroupTimes> groups;
  for (const std::uint32_t source : plan.sources()) {
    groups.push_back(Group(plan, source).times(legs, passage, speed_mps));
  }
  return groups;
}

std::string to_table(const std::vector<GroupTimes>& groups, const std::optional<Passage>& passage,
                     double robots) {
  std::string text = passage
                         ? fmt::format(
                               "narrowest passage: {:.1f} m between ({:.1f}, {:.1f}) and ({:.1f}, "
                               "{:.1f}) m\n",
                               passage->width_m(), passage->from_m.x(), passage->from_m.y(),
                               passage->to_m.x(), passage->to_m.y())
                         : std::string("no passage between two obstacles\n");
  text += "times in s: first, half, last\n";
  text += fmt::format("{:>5} {:>6} | {:^20} | {:^20} | {:^20} | {:>5}\n", "group", "robots",
                      "leaves", "passes", "arrives", "waits");
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const GroupTimes& group = groups[i];
    text += fmt::format("{:>5} {:>6.0f} | {} | {:^20} | {} | {:>5.1f}\n", i, group.share * robots,
                        to_text(group.leaves), group.passes ? to_text(*group.passes) : "-",
                        to_text(group.arrives), group.waits_on_average.count());
  }
  return text;
}

}  // namespace swarm::planner
