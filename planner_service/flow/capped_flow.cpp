// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/capped_flow.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "planner_service/flow/min_cost_flow.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// Newton's method below ends after as many steps as there are different cuts under way: a handful.
constexpr int kMostCuts = 64;
// Mass below kFits counts as none; an arc with less than kSaturated left counts as full.
constexpr double kFits = 1e-9;
constexpr double kSaturated = 1e-11;

struct Terminals {
  std::span<const double> supplies;
  std::span<const double> demands;
  std::size_t goal_node(std::size_t j) const { return supplies.size() + j; }
};

// Node v of the roadmap is split into 2v, where mass comes in, and 2v + 1, where it leaves. The
// first arcs are those between the two, in order of v.
std::uint32_t in_of(std::size_t v) { return static_cast<std::uint32_t>(2 * v); }
std::uint32_t out_of(std::size_t v) { return static_cast<std::uint32_t>(2 * v + 1); }

struct SplitNetwork {
  std::vector<double> balance;
  std::vector<FlowArc> arcs;
};

// The roadmap as a flow network with node capacities: splitting a node turns its capacity into that
// of an arc (the standard reduction). Closed edges are left out.
SplitNetwork split_network(const Roadmap& roadmap, const Terminals& terminals,
                           const DensityCap& cap) {
  SplitNetwork net;
  net.balance.assign(2 * roadmap.nodes.size(), 0.0);
  net.arcs.reserve(roadmap.nodes.size() + roadmap.arcs.size());
  for (std::size_t i = 0; i < terminals.supplies.size(); ++i) {
    net.balance[in_of(i)] = terminals.supplies[i];
  }
  for (std::size_t j = 0; j < terminals.demands.size(); ++j) {
    net.balance[out_of(terminals.goal_node(j))] = -terminals.demands[j];
  }
  for (std::size_t v = 0; v < roadmap.nodes.size(); ++v) {
    net.arcs.push_back({in_of(v), out_of(v), 0.0, mass_capacity(roadmap.nodes[v], cap)});
  }
  for (std::uint32_t v = 0; v < roadmap.nodes.size(); ++v) {
    for (const Roadmap::Arc& arc : roadmap.arcs_of(v)) {
      if (!std::isfinite(arc.length_m)) continue;
      net.arcs.push_back({.from = out_of(v), .to = in_of(arc.to), .cost = arc.length_m});
    }
  }
  return net;
}

// The minimum cut at one density: the mass that fits through at density ρ is at most passed + ρ ·
// per_density, with equality at the ρ the cut was found for.
struct Cut {
  double unserved = 0.0;
  double passed = 0.0;
  double per_density = 0.0;
};

// Maximum flow, posed as min-cost flow: every start has a bypass to all goals, and only the bypass
// has a cost. The minimum cut follows from its residual network.
Cut smallest_cut(const Roadmap& roadmap, const Terminals& terminals, const DensityCap& cap) {
  SplitNetwork net = split_network(roadmap, terminals, cap);
  for (FlowArc& arc : net.arcs) arc.cost = 0.0;
  const std::size_t bypasses = net.arcs.size();
  const auto hub = static_cast<std::uint32_t>(net.balance.size());
  net.balance.push_back(0.0);
  for (std::size_t i = 0; i < terminals.supplies.size(); ++i) {
    net.arcs.push_back({.from = in_of(i), .to = hub, .cost = 1.0});
  }
  for (std::size_t j = 0; j < terminals.demands.size(); ++j) {
    net.arcs.push_back({.from = hub, .to = out_of(terminals.goal_node(j))});
  }
  const auto flow = min_cost_flow(net.balance, net.arcs);
  SWARM_ASSERT(flow.has_value());

  // The nodes that the unserved starts reach in the residual network are one side of the cut.
  std::vector<std::vector<std::uint32_t>> residual(net.balance.size());
  for (std::size_t a = 0; a < bypasses; ++a) {
    const FlowArc& arc = net.arcs[a];
    if (arc.capacity - (*flow)[a] > kSaturated) residual[arc.from].push_back(arc.to);
    if ((*flow)[a] > kSaturated) residual[arc.to].push_back(arc.from);
  }
  Cut cut;
  std::vector<char> reached(net.balance.size(), 0);
  std::vector<std::uint32_t> open;
  for (std::size_t i = 0; i < terminals.supplies.size(); ++i) {
    const double unserved = (*flow)[bypasses + i];
    cut.unserved += unserved;
    if (unserved <= kSaturated) continue;
    reached[in_of(i)] = 1;
    open.push_back(in_of(i));
  }
  while (!open.empty()) {
    const std::uint32_t v = open.back();
    open.pop_back();
    for (const std::uint32_t w : residual[v]) {
      if (reached[w] != 0) continue;
      reached[w] = 1;
      open.push_back(w);
    }
  }
  for (std::size_t i = 0; i < terminals.supplies.size(); ++i) {
    if (reached[in_of(i)] == 0) cut.passed += terminals.supplies[i];
  }
  for (std::size_t j = 0; j < terminals.demands.size(); ++j) {
    if (reached[out_of(terminals.goal_node(j))] != 0) cut.passed += terminals.demands[j];
  }
  for (std::size_t v = 0; v < roadmap.nodes.size(); ++v) {
    if (reached[in_of(v)] != 0 && reached[out_of(v)] == 0) {
      cut.per_density += net.arcs[v].capacity / cap.max_per_m2;
    }
  }
  return cut;
}

// The error of an infeasible flow: the share that fits, and the least density at which all would
// fit.
Error does_not_fit(const Roadmap& roadmap, const Terminals& terminals, const DensityCap& cap) {
  Cut cut = smallest_cut(roadmap, terminals, cap);
  const double fits = 1.0 - cut.unserved;
  // Newton's method on the concave, piecewise linear mass that fits at ρ: each cut is a tangent.
  DensityCap enough = cap;
  for (int i = 0; i < kMostCuts && cut.unserved > kFits && cut.per_density > 0.0; ++i) {
    enough.max_per_m2 = (1.0 - cut.passed) / cut.per_density;
    cut = smallest_cut(roadmap, terminals, enough);
  }
  std::string cure = "no density lets all of it through: the roadmap does not join all components";
  if (cut.unserved <= kFits) {
    cure = fmt::format("all of it fits at {:.3f} robots/m2", enough.max_per_m2);
  }
  return {ErrorCode::kInfeasible,
          fmt::format("at no more than {:.3f} robots/m2, {:.1f} % of {:.0f} robots fit through the "
                      "roadmap at the same time; {}; raise the density, planner.sigma_max_m or "
                      "planner.samples, or let groups pass one after the other",
                      cap.max_per_m2, 100.0 * fits, cap.robots, cure)};
}

// Decomposes the flow into routes: each follows the remaining flow from a start to a goal and takes
// as much as its thinnest arc carries, which empties an arc.
class RouteTaker {
 public:
  RouteTaker(const Roadmap& roadmap, const Terminals& terminals, std::span<const double> flow,
             std::span<const FlowArc> arcs)
      : roadmap_(roadmap), terminals_(terminals), out_(roadmap.nodes.size()) {
    for (std::size_t a = roadmap.nodes.size(); a < arcs.size(); ++a) {
      if (flow[a] > 0.0) out_[arcs[a].from / 2].push_back({arcs[a].to / 2, flow[a]});
    }
    left_.assign(terminals.demands.begin(), terminals.demands.end());
  }

  std::vector<Route> take() {
    std::vector<Route> routes;
    for (std::size_t i = 0; i < terminals_.supplies.size(); ++i) {
      double left = terminals_.supplies[i];
      while (left > kFits) {
        std::optional<Route> route = next(i, left);
        if (!route) break;
        left -= route->mass;
        routes.push_back(*std::move(route));
      }
    }
    return routes;
  }

 private:
  struct Carrying {
    std::uint32_t to;
    double mass;
  };

  // Follows the arc with most mass at each node until a goal has demand left. Nothing when rounding
  // left no arc to follow. Costs are positive, so an optimal flow has no cycles and the walk ends.
  std::optional<Route> next(std::size_t start, double left) {
    std::vector<std::uint32_t> nodes{static_cast<std::uint32_t>(start)};
    std::vector<Carrying*> taken;
    double mass = left;
    for (;;) {
      const std::uint32_t v = nodes.back();
      const std::size_t goal = v - terminals_.supplies.size();
      if (v >= terminals_.supplies.size() && goal < left_.size() && left_[goal] > kFits) {
        mass = std::min(mass, left_[goal]);
        left_[goal] -= mass;
        for (Carrying* arc : taken) arc->mass -= mass;
        Route route{start, goal, mass, {}};
        for (const std::uint32_t node : nodes) route.waypoints.push_back(roadmap_.nodes[node]);
        return route;
      }
      const auto arc =
          std::max_element(out_[v].begin(), out_[v].end(),
                           [](const Carrying& a, const Carrying& b) { return a.mass < b.mass; });
      if (arc == out_[v].end() || arc->mass <= kNegligibleFlow || nodes.size() > out_.size()) {
        return std::nullopt;
      }
      mass = std::min(mass, arc->mass);
      taken.push_back(&*arc);
      nodes.push_back(arc->to);
    }
  }

  const Roadmap& roadmap_;
  Terminals terminals_;
  std::vector<std::vector<Carrying>> out_;
  std::vector<double> left_;  // demand of each goal
};

// The roadmap's edges are proven to a coarse tolerance. Those that carry mass are proven to that of
// a plan, and closed where that fails. False when an edge was closed.
bool prove_used_edges(Roadmap& roadmap, std::span<const double> flow, std::span<const FlowArc> arcs,
                      EdgeChecker& checker) {
  bool proven = true;
  for (std::size_t a = roadmap.nodes.size(); a < arcs.size(); ++a) {
    if (flow[a] == 0.0) continue;
    const std::uint32_t from = arcs[a].from / 2;
    const std::uint32_t to = arcs[a].to / 2;
    if (checker.is_free(roadmap.nodes[from], roadmap.nodes[to], kPlanTolerance_m)) continue;
    roadmap.close_edge(from, to);
    proven = false;
  }
  return proven;
}

}  // namespace

// Solve, prove, close and repeat; the flow of the last round is decomposed into routes.
Result<CappedFlow> capped_flow(Roadmap& roadmap, std::span<const double> supplies,
                               std::span<const double> demands, const DensityCap& cap,
                               EdgeChecker& checker) {
  const Terminals terminals{supplies, demands};
  SWARM_ASSERT(roadmap.nodes.size() >= supplies.size() + demands.size());
  if (auto checked = check_components(roadmap.nodes, supplies, demands, cap); !checked) {
    return tl::unexpected(checked.error());
  }
  // Every round but the last closes an edge.
  for (;;) {
    const SplitNetwork net = split_network(roadmap, terminals, cap);
    const auto flow = min_cost_flow(net.balance, net.arcs);
    if (!flow) return tl::unexpected(does_not_fit(roadmap, terminals, cap));
    if (!prove_used_edges(roadmap, *flow, net.arcs, checker)) continue;
    CappedFlow result;
    for (std::size_t a = 0; a < net.arcs.size(); ++a)
      result.cost_m += (*flow)[a] * net.arcs[a].cost;
    result.routes = RouteTaker(roadmap, terminals, *flow, net.arcs).take();
    return result;
  }
}

}  // namespace swarm::planner
