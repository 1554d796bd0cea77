// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/risk_graph.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

constexpr double kUnreachable = std::numeric_limits<double>::infinity();

// A source whose mean is nearer to an obstacle than the mean clearance allows must keep this share
// of its own clearance on its arcs instead.
constexpr double kOwnClearance = 0.99;

// Cost and memory grow with the checks between steps.
constexpr std::size_t kMaxChecksBetween = 9;

// Equal but for rounding, so that find() maps a mixture that a step returned back to its vertices.
bool same_but_for_rounding(const Gaussian& a, const Gaussian& b) {
  return (a.mean_m() - b.mean_m()).cwiseAbs().maxCoeff() < 1e-9 &&
         (a.covariance_m2() - b.covariance_m2()).cwiseAbs().maxCoeff() < 1e-9;
}

Result<void> check(const RiskGraphOptions& options) {
  const bool valid = options.transport_radius_m > 0.0 && options.mean_clearance_m >= 0.0 &&
                     options.risk_weight >= 0.0 && options.risk.alpha > 0.0 &&
                     options.risk.alpha < 1.0 && options.risk.delta_m <= 0.0 &&
                     options.checks_between <= kMaxChecksBetween &&
                     std::isfinite(options.transport_radius_m + options.risk_weight);
  if (valid) return {};
  return fail(ErrorCode::kBadInput,
              fmt::format("risk graph: transport radius {} m must be > 0, mean clearance {} m and "
                          "risk weight {} >= 0, alpha {} in (0, 1), epsilon {} m <= 0, checks "
                          "between steps {} at most {}",
                          options.transport_radius_m, options.mean_clearance_m, options.risk_weight,
                          options.risk.alpha, options.risk.delta_m, options.checks_between,
                          kMaxChecksBetween));
}

}  // namespace

Result<RiskGraph> RiskGraph::make(const World& world, const Mixture& goal,
                                  const RiskGraphOptions& options) {
  if (auto checked = check(options); !checked) return tl::unexpected(checked.error());
  auto set = collocation_set(world.bounds_m(), options.collocation);
  if (!set) return tl::unexpected(set.error());
  RiskGraph graph;
  graph.world_ = &world;
  graph.options_ = options;
  graph.k_ = cvar_coefficient(options.risk.alpha);
  graph.near_.assign(options.checks_between + 1,
                     std::vector<std::vector<Near>>(world.convex_obstacles().size()));
  graph.goals_ = goal.components().size();
  for (std::size_t n = 0; n < graph.goals_; ++n) {
    const Gaussian& g = goal.components()[n].gaussian;
    if (!world.is_clear(g.mean_m(), options.mean_clearance_m)) {
      return fail(ErrorCode::kInfeasible,
                  fmt::format("goal component {}: its mean is {:.3f} m from an obstacle, {} m are "
                              "kept; move the goal",
                              n, world.distance_m(g.mean_m()), options.mean_clearance_m));
    }
    graph.add_vertex(g);
  }
  for (const Gaussian& g : *set) {
    if (world.is_clear(g.mean_m(), options.mean_clearance_m)) graph.add_vertex(g);
  }
  graph.base_ = static_cast<std::uint32_t>(graph.vertices_.size());
  for (std::uint32_t v = 0; v < graph.base_; ++v) graph.add_arcs(v, graph.base_);
  graph.see_arcs_from(0);
  graph.to_goal_m_.assign(graph.vertices_.size() * graph.goals_, kUnreachable);
  for (std::size_t n = 0; n < graph.goals_; ++n) graph.search(n);
  return graph;
}

// Computes the risk r of a vertex and enters it in the lists of the convex obstacles its tail may
// reach. Bounding boxes rule out most obstacles.
void RiskGraph::add_vertex(const Gaussian& g) {
  const auto index = static_cast<std::uint32_t>(vertices_.size());
  vertices_.push_back(g);
  double worst_m = -kUnreachable;
  double clearance_m = kUnreachable;
  const double reach_m = kNearSigmas * g.max_sigma_m();
  const std::vector<ConvexObstacle>& obstacles = world_->convex_obstacles();
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (obstacles[o].box.distance_m(g.mean_m()) > reach_m) continue;
    const SignedDistance at_mean = obstacles[o].signed_distance(g.mean_m());
    // −sd is linearised at the mean: normal with mean −s(μ) and the variance along the gradient.
    const double sigma_m = std::sqrt(g.variance_along_m2(at_mean.gradient));
    worst_m = std::max(worst_m, -at_mean.distance_m + k_ * sigma_m);
    clearance_m = std::min(clearance_m, at_mean.distance_m);
    if (at_mean.distance_m > kNearSigmas * sigma_m) continue;
    near_[0][o].push_back({index, {0.0, -at_mean.distance_m, sigma_m}});
  }
  risk_.push_back(std::max(0.0, worst_m - options_.risk.delta_m) / (k_ * g.max_sigma_m()));
  clearance_m_.push_back(clearance_m);
}

// Enters the arcs from `first` on in the lists of the obstacles near them, at each check between
// two steps: the Gaussian on the W₂ geodesic of the arc at that time.
void RiskGraph::see_arcs_from(std::uint32_t first) {
  const std::vector<ConvexObstacle>& obstacles = world_->convex_obstacles();
  const auto parts = static_cast<double>(near_.size());
  std::uint32_t from = 0;
  for (std::uint32_t a = first; a < arcs_.size() && near_.size() > 1; ++a) {
    while (arc_offset_[from + 1] <= a) ++from;
    const Geodesic geodesic(vertices_[from], vertices_[arcs_[a].to]);
    for (std::size_t part = 1; part < near_.size(); ++part) {
      const Gaussian g = geodesic.at(static_cast<double>(part) / parts);
      const double reach_m = kNearSigmas * g.max_sigma_m();
      for (std::size_t o = 0; o < obstacles.size(); ++o) {
        if (obstacles[o].box.distance_m(g.mean_m()) > reach_m) continue;
        const SignedDistance at_mean = obstacles[o].signed_distance(g.mean_m());
        const double sigma_m = std::sqrt(g.variance_along_m2(at_mean.gradient));
        if (at_mean.distance_m > kNearSigmas * sigma_m) continue;
        near_[part][o].push_back({a, {0.0, -at_mean.distance_m, sigma_m}});
      }
    }
  }
}

// The length of an arc as in the class comment: W₂ (1 + κ (rᵢ + rⱼ)/2).
double RiskGraph::arc_length_m(double w2_m, std::uint32_t from, std::uint32_t to) const {
  return w2_m * (1.0 + 0.5 * options_.risk_weight * (risk_[from] + risk_[to]));
}

// Appends the arcs of a vertex to the first `among` vertices. Arcs are stored in compressed rows,
// so that vertices have to be added in order.
void RiskGraph::add_arcs(std::uint32_t from, std::uint32_t among) {
  const Gaussian& g = vertices_[from];
  const double clearance_m =
      std::min(options_.mean_clearance_m, std::max(0.0, kOwnClearance * clearance_m_[from]));
  std::vector<std::pair<double, std::uint32_t>> reached;
  double nearest_m = kUnreachable;
  for (std::uint32_t to = 0; to < among; ++to) {
    if (to == from) continue;
    // W₂ is at least the distance of the means.
    const double means_m = (vertices_[to].mean_m() - g.mean_m()).norm();
    if (means_m > std::max(options_.transport_radius_m, 2.0 * nearest_m)) continue;
    const double w2_m = wasserstein2(g, vertices_[to]);
    nearest_m = std::min(nearest_m, w2_m);
    reached.emplace_back(w2_m, to);
  }
  const bool is_source = from >= base_ && base_ > 0;
  const double radius_m = is_source ? std::max(options_.transport_radius_m, 2.0 * nearest_m)
                                    : options_.transport_radius_m;
  arcs_.push_back({from, 0.0, 0.0});
  for (const auto& [w2_m, to] : reached) {
    if (w2_m > radius_m) continue;
    if (!world_->segment_is_free(g.mean_m(), vertices_[to].mean_m(), clearance_m)) continue;
    arcs_.push_back({to, w2_m, arc_length_m(w2_m, from, to)});
  }
  arc_offset_.push_back(static_cast<std::uint32_t>(arcs_.size()));
}

// Dijkstra from the goal. It follows arcs backwards, which needs no reverse graph: arcs between
// base vertices come in pairs of the same length.
void RiskGraph::search(std::size_t goal) {
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto length_m = [&](std::uint32_t v) -> double& { return to_goal_m_[v * goals_ + goal]; };
  const auto target = static_cast<std::uint32_t>(goal);
  length_m(target) = 0.0;
  queue.emplace(0.0, target);
  while (!queue.empty()) {
    const auto [settled_m, vertex] = queue.top();
    queue.pop();
    if (settled_m > length_m(vertex)) continue;  // an older, longer entry
    for (const Arc& arc : arcs_of(vertex)) {
      const double through_m = settled_m + arc.length_m;
      if (through_m >= length_m(arc.to)) continue;
      length_m(arc.to) = through_m;
      queue.emplace(through_m, arc.to);
    }
  }
}

std::optional<std::uint32_t> RiskGraph::find(const Gaussian& g) const {
  for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
    if (same_but_for_rounding(vertices_[v], g)) return v;
  }
  return std::nullopt;
}

// Adds a vertex with arcs out of it alone, so that the path lengths of all others stay as they are;
// its own follow from its arcs and their ends.
std::optional<std::uint32_t> RiskGraph::add_source(const Gaussian& g) {
  if (world_->distance_m(g.mean_m()) <= 0.0) return std::nullopt;
  const auto index = static_cast<std::uint32_t>(vertices_.size());
  add_vertex(g);
  add_arcs(index, base_);
  see_arcs_from(arc_offset_[index]);
  for (std::size_t n = 0; n < goals_; ++n) {
    double best_m = kUnreachable;
    for (const Arc& arc : arcs_of(index)) {
      if (arc.to != index) best_m = std::min(best_m, arc.length_m + to_goal_m(arc.to, n));
    }
    to_goal_m_.push_back(best_m);
  }
  return index;
}

// Sources were appended last, so that everything is cut back to the base sizes.
void RiskGraph::drop_sources() {
  for (std::size_t part = 0; part < near_.size(); ++part) {
    const std::uint32_t kept = part == 0 ? base_ : arc_offset_[base_];
    for (std::vector<Near>& list : near_[part]) {
      while (!list.empty() && list.back().index >= kept) list.pop_back();
    }
  }
  vertices_.resize(base_);
  risk_.resize(base_);
  clearance_m_.resize(base_);
  arc_offset_.resize(base_ + 1);
  arcs_.resize(arc_offset_[base_]);
  to_goal_m_.resize(base_ * goals_);
}

}  // namespace swarm::planner
