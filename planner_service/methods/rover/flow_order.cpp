// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <utility>

#include "planner_service/flow/min_cost_flow.hpp"
#include "planner_service/groups/plan_entry.hpp"
#include "planner_service/groups/robot_groups.hpp"
#include "planner_service/methods/rover/flow_groups.hpp"
#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarm_core/plan/flow_draw.hpp"

namespace swarm::planner {
namespace {

/// A route out of a source and the ranks whose shares draw it.
struct SourceRoute {
  FlowPosition place;
  std::vector<std::uint32_t> ranks;
};

// Follows the share of every rank through the plan, as a robot does, and groups the ranks by first
// leg and sink.
std::vector<SourceRoute> routes_of(const FlowPlan& plan, std::size_t source, std::uint32_t size) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> ranks;
  const MissionTime begin = plan.nodes()[plan.sources()[source]].time;
  for (std::uint32_t rank = 0; rank < size; ++rank) {
    const double share = PlanEntry::share_of(stratified_share(rank, size)) / 65536.0;
    const FlowPosition place = position_in_flow(plan, source, share, begin);
    ranks[{place.leg, place.sink}].push_back(rank);
  }
  std::vector<SourceRoute> routes;
  for (auto& [route, of] : ranks) routes.push_back({{route.first, route.second}, std::move(of)});
  return routes;
}

// Costs of the assignment: squared distance to the end of the first leg.
class Costs {
 public:
  Costs(const FlowPlan& plan, const Mixture& goal, const RobotGroup& group,
        const std::vector<SourceRoute>& routes)
      : from_m_(group.gaussian.mean_m()) {
    for (const SourceRoute& route : routes) {
      const bool moves = route.place.leg != FlowPosition::kAtSink;
      const Gaussian& to =
          moves ? plan.nodes()[plan.legs()[route.place.leg].to].gaussian : group.gaussian;
      ends_.push_back({to.mean_m(), transport_map(group.gaussian, to),
                       component_at(goal, plan.nodes()[route.place.sink].gaussian.mean_m())});
    }
  }

  // The optimal transport map keeps the robot's offset within its group: it is carried to μ + T y.
  double of(const ReportedRobot& robot, std::size_t route) const {
    const End& end = ends_[route];
    const Vec2 to_m = end.mean_m + end.map * (robot.position_m - from_m_);
    const bool other = robot.goal && end.goal != robot.goal;
    return (to_m - robot.position_m).squaredNorm() + (other ? kOtherGoal_m2 : 0.0);
  }

 private:
  struct End {
    Vec2 mean_m;
    Mat2 map;
    std::optional<std::uint32_t> goal;
  };
  Vec2 from_m_;
  std::vector<End> ends_;
};

/// The route of each member, as many on each as it has ranks: an assignment problem, solved as
/// min-cost flow, whose basic solution is integral (within rounding) for integral supplies.
std::vector<std::size_t> cheapest(const std::vector<const ReportedRobot*>& members,
                                  const std::vector<SourceRoute>& routes, const Costs& costs) {
  const auto robots = static_cast<std::uint32_t>(members.size());
  std::vector<double> supplies(members.size(), 1.0);
  std::vector<FlowArc> arcs;
  for (const SourceRoute& route : routes)
    supplies.push_back(-static_cast<double>(route.ranks.size()));
  for (std::uint32_t i = 0; i < robots; ++i) {
    for (std::uint32_t w = 0; w < routes.size(); ++w) {
      arcs.push_back({.from = i, .to = robots + w, .cost = costs.of(*members[i], w)});
    }
  }
  const auto flow = min_cost_flow(supplies, arcs);
  SWARM_ASSERT(flow.has_value());
  std::vector<std::size_t> chosen(members.size(), 0);
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    if ((*flow)[a] > 0.5) chosen[arcs[a].from] = arcs[a].to - robots;
  }
  return chosen;
}

}  // namespace

// Routes are drawn by share, and shares by rank: the order of the members decides who takes which
// route. A group with one route needs no order.
void order_by_flow(std::vector<RobotGroup>& groups, const FlowPlan& plan, const Mixture& goal,
                   std::span<const ReportedRobot> robots) {
  std::map<std::uint32_t, const ReportedRobot*> by_id;
  for (const ReportedRobot& robot : robots) by_id[robot.robot.value()] = &robot;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    RobotGroup& group = groups[g];
    const std::vector<SourceRoute> routes =
        routes_of(plan, g, static_cast<std::uint32_t>(group.members.size()));
    if (routes.size() < 2) continue;
    std::vector<const ReportedRobot*> members;
    for (const RobotId id : group.members) members.push_back(by_id.at(id.value()));
    const std::vector<std::size_t> route_of =
        cheapest(members, routes, Costs(plan, goal, group, routes));
    std::vector<std::size_t> used(routes.size(), 0);
    std::vector<RobotId> ordered(group.members.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
      ordered[routes[route_of[i]].ranks[used[route_of[i]]++]] = members[i]->robot;
    }
    group.members = std::move(ordered);
  }
}

}  // namespace swarm::planner
