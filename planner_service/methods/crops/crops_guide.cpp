// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/crops/crops_guide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "planner_service/flow/cheapest_paths.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "planner_service/roadmap/endpoints.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// Points drawn per wanted sample before the free space counts as full.
constexpr std::size_t kGuideTriesPerSample = 200;
// Limit of the factor that repeated congestion may put on an edge: costs stay finite, and an edge
// is never closed.
constexpr double kCostliest = 1e6;
// An obstacle at exactly the clearance of an end must not count as nearer because of rounding.
constexpr double kJustBelow = 1.0 - 1e-9;

// A Gaussian with the same σ in all directions: the guide plans for points with a circle around
// them.
Gaussian round_at(const Vec2& mean_m, double sigma_m) {
  return Gaussian::from_parameters(mean_m, sigma_m, sigma_m, 0.0);
}

// Distance from p to the nearest point of a segment, which may be a single point.
double distance_to_segment_m(const Vec2& p, const Vec2& from_m, const Vec2& to_m) {
  const Vec2 segment = to_m - from_m;
  const double squared = segment.squaredNorm();
  const double t = squared > 0.0 ? std::clamp(segment.dot(p - from_m) / squared, 0.0, 1.0) : 0.0;
  return (from_m + t * segment - p).norm();
}

// Index of the path's leg nearest to a point.
std::size_t leg_at(const std::vector<std::uint32_t>& path, const std::vector<Vec2>& points_m,
                   const Vec2& at_m) {
  std::size_t nearest = 0;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double distance_m = distance_to_segment_m(at_m, points_m[path[i]], points_m[path[i + 1]]);
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    nearest = i;
  }
  return nearest;
}

}  // namespace

// Each obstacle counts once, by its nearest convex part: how it is decomposed must not change its
// weight. Boxes rule out parts that cannot be nearer.
double clearance_weight(const World& world, const Vec2& point_m, double power) {
  const std::vector<ConvexObstacle>& parts = world.convex_obstacles();
  if (parts.empty()) return 1.0;
  // The convex parts of one obstacle are adjacent in the list.
  double sum_m = 0.0;
  for (std::size_t i = 0; i < parts.size();) {
    const std::size_t obstacle = parts[i].obstacle;
    double nearest_m = std::numeric_limits<double>::infinity();
    for (; i < parts.size() && parts[i].obstacle == obstacle; ++i) {
      if (parts[i].box.distance_m(point_m) >= nearest_m) continue;
      nearest_m = std::min(nearest_m, parts[i].signed_distance(point_m).distance_m);
    }
    sum_m += nearest_m;
  }
  return std::pow(sum_m, power);
}

double guide_cost(double length_m, double weight_i, double weight_j) {
  return length_m / std::min(weight_i, weight_j);
}

CropsGuide::CropsGuide(const World& world, const RiskLimit& risk, const CropsOptions& options)
    : world_(&world),
      risk_(risk),
      options_(options),
      k_(cvar_coefficient(risk.alpha)),
      edge_clearance_m_(k_ * options.sigma_min_m - risk.delta_m) {
  SWARM_ASSERT(options.clearance_min_m >= 0.0 && options.connection_radius_m >= 0.0);
  SWARM_ASSERT(options.sigma_min_m >= Gaussian::kMinSigma_m);
  SWARM_ASSERT(options.goal_radius_m >= 2.0 * options.sigma_min_m && options.stuck_factor >= 1.0);
}

// Alternates sampling and searching: the first round draws N samples, each further one N/2 + 1,
// until every pair of components is joined. Halton points of all rounds continue one sequence.
Result<CropsGuide> CropsGuide::make(const World& world, const Mixture& start, const Mixture& goal,
                                    const RiskLimit& risk, const CropsOptions& options, Rng& rng) {
  CropsGuide guide(world, risk, options);
  if (auto set = guide.set_ends(start, goal); !set) return tl::unexpected(set.error());
  HaltonMeans means(world.bounds_m(), rng);
  std::size_t more = options.samples;
  for (std::uint32_t round = 0; round <= options.rounds_max; ++round) {
    const bool full = guide.add_samples(more, means) < more;
    guide.connect();
    const bool solved = guide.search();
    if (solved && std::all_of(guide.costs_.begin(), guide.costs_.end(),
                              [](double cost) { return std::isfinite(cost); })) {
      return guide;
    }
    // Out of space or rounds: a solution of the transport that avoids the unjoined pairs is
    // accepted.
    if (full || round == options.rounds_max) {
      if (solved) return guide;
      break;
    }
    more = options.samples / 2 + 1;
  }
  return tl::unexpected(guide.no_path());
}

// Replaces the points of start and goal in front of the samples, which keep their order.
Result<void> CropsGuide::set_ends(const Mixture& start, const Mixture& goal) {
  if (auto ok = check_endpoints(*world_, start, goal, risk_); !ok) return ok;
  std::vector<Vec2> ends_m;
  std::vector<double> weights;
  for (const Mixture* mixture : {&start, &goal}) {
    for (const WeightedGaussian& component : mixture->components()) {
      ends_m.push_back(component.gaussian.mean_m());
      weights.push_back(clearance_weight(*world_, ends_m.back(), options_.clearance_power));
    }
  }
  const auto old = static_cast<std::ptrdiff_t>(terminals());
  points_m_.erase(points_m_.begin(), points_m_.begin() + old);
  points_m_.insert(points_m_.begin(), ends_m.begin(), ends_m.end());
  weights_.erase(weights_.begin(), weights_.begin() + old);
  weights_.insert(weights_.begin(), weights.begin(), weights.end());
  starts_ = start.components();
  goals_ = goal.components();
  return {};
}

// connect() computes all costs anew. The congestion factors of edges between samples are taken off
// the old graph first, by sample number, since node numbers shift with the number of ends.
Result<void> CropsGuide::move_ends(const Mixture& start, const Mixture& goal) {
  struct Reweighted {
    std::uint32_t from, to;  // samples
    double factor;
  };
  std::vector<Reweighted> reweighted;
  const auto old = static_cast<std::uint32_t>(terminals());
  for (std::uint32_t from = old; from < points_m_.size(); ++from) {
    for (std::uint32_t a = graph_.arc_offset[from]; a < graph_.arc_offset[from + 1]; ++a) {
      const Roadmap::Arc& arc = graph_.arcs[a];
      if (arc.to < old || arc.length_m == first_cost_[a]) continue;
      reweighted.push_back({from - old, arc.to - old, arc.length_m / first_cost_[a]});
    }
  }
  routes_.clear();
  paths_.clear();
  if (auto set = set_ends(start, goal); !set) return set;
  connect();
  const auto now = static_cast<std::uint32_t>(terminals());
  for (const Reweighted& d : reweighted) {
    for (std::uint32_t a = graph_.arc_offset[d.from + now]; a < graph_.arc_offset[d.from + now + 1];
         ++a) {
      if (graph_.arcs[a].to == d.to + now) graph_.arcs[a].length_m *= d.factor;
    }
  }
  if (!search()) return tl::unexpected(no_path());
  return {};
}

// Draws free points of the Halton sequence. Returns the number found, fewer than `count` when the
// tries are used up.
std::size_t CropsGuide::add_samples(std::size_t count, HaltonMeans& means) {
  const double clearance_m = std::max(options_.clearance_min_m, edge_clearance_m_);
  // The bounds are walls to robots: a gap beside them is as wide as one between obstacles.
  const Box& bounds = world_->bounds_m();
  const Box inside{bounds.min_m.array() + clearance_m, bounds.max_m.array() - clearance_m};
  std::size_t added = 0;
  for (std::size_t tries = kGuideTriesPerSample * count; tries > 0 && added < count; --tries) {
    const Vec2 point_m = means.next();
    if (!inside.contains(point_m) || !world_->is_clear(point_m, clearance_m)) continue;
    points_m_.push_back(point_m);
    ++added;
  }
  return added;
}

// Rebuilds the graph: neighbours within the radius, tested for visibility nearest first, with the
// cost of guide_cost() on each edge.
void CropsGuide::connect() {
  for (std::size_t i = weights_.size(); i < points_m_.size(); ++i) {
    weights_.push_back(clearance_weight(*world_, points_m_[i], options_.clearance_power));
  }
  graph_.nodes.clear();
  for (const Vec2& point_m : points_m_) {
    graph_.nodes.push_back(round_at(point_m, 0.5 * options_.goal_radius_m));
  }
  // A start or goal may be nearer to an obstacle than any sample: its edges need to keep only the
  // clearance it has itself.
  const auto clearance_m = [&](std::uint32_t node) {
    return node < terminals() ? kJustBelow * world_->distance_m(points_m_[node])
                              : std::numeric_limits<double>::infinity();
  };
  std::vector<NeighbourPair> pairs =
      find_neighbours(graph_.nodes, options_.connection_radius_m, terminals());
  std::sort(pairs.begin(), pairs.end(), [](const NeighbourPair& l, const NeighbourPair& r) {
    return std::tie(l.distance_m, l.a, l.b) < std::tie(r.distance_m, r.a, r.b);
  });
  // Nearest first, an edge is taken as long as one of its ends has fewer than k edges.
  std::vector<std::uint32_t> asked(points_m_.size(), 0);
  std::erase_if(pairs, [&](const NeighbourPair& pair) {
    if (std::min(asked[pair.a], asked[pair.b]) >= options_.neighbours_max) return true;
    const double needed_m = std::min({edge_clearance_m_, clearance_m(pair.a), clearance_m(pair.b)});
    if (!is_visible(pair, needed_m)) return true;
    ++asked[pair.a];
    ++asked[pair.b];
    return false;
  });

  for (NeighbourPair& pair : pairs) {
    pair.distance_m = guide_cost(pair.distance_m, weights_[pair.a], weights_[pair.b]);
  }
  graph_ = assemble(std::move(graph_.nodes), pairs);
  first_cost_.clear();
  for (const Roadmap::Arc& arc : graph_.arcs) first_cost_.push_back(arc.length_m);
}

// Visibility between samples is cached by their numbers: further rounds and new ends test the same
// pairs again. Pairs with a start or goal are not cached, since those move.
bool CropsGuide::is_visible(const NeighbourPair& pair, double clearance_m) {
  const auto free = [&] {
    return world_->segment_is_free(points_m_[pair.a], points_m_[pair.b], clearance_m);
  };
  if (pair.a < terminals()) return free();
  const std::uint64_t first = pair.a - terminals();
  const auto [known, is_new] = visible_.try_emplace(first << 32U | (pair.b - terminals()), false);
  if (is_new) known->second = free();
  return known->second;
}

// Cheapest paths between all ends, the transport problem over their costs, and a route of Gaussians
// for each shipment. False when no transport is possible.
bool CropsGuide::search() {
  PathTransport transport = transport_on_paths(graph_, weights_of(starts_), weights_of(goals_));
  costs_ = std::move(transport.costs);
  if (transport.paths.empty()) return false;
  routes_.clear();
  paths_.clear();
  for (auto& [shipment, path] : transport.paths) {
    paths_.push_back(std::move(path));
    routes_.push_back({shipment.from, shipment.to, shipment.mass,
                       waypoints_along(paths_.back(), starts_[shipment.from].gaussian,
                                       goals_[shipment.to].gaussian)});
  }
  return true;
}

// Largest σ ≤ goal_radius_m/2 of a round Gaussian that keeps δ everywhere on a segment: the segment
// has to be k σ − δ from all obstacles. Found by bisection, since the visibility test is monotone
// in σ.
double CropsGuide::sigma_beside_m(const Vec2& from_m, const Vec2& to_m) const {
  const auto fits = [&](double sigma_m) {
    return world_->segment_is_free(from_m, to_m, k_ * sigma_m - risk_.delta_m);
  };
  double high_m = 0.5 * options_.goal_radius_m;
  if (fits(high_m)) return high_m;
  // Every edge keeps at least this; a start or goal close to a wall keeps little.
  double low_m = Gaussian::kMinSigma_m;
  constexpr int kHalvings = 20;  // to a millionth of the circle
  for (int i = 0; i < kHalvings; ++i) {
    const double middle_m = 0.5 * (low_m + high_m);
    (fits(middle_m) ? low_m : high_m) = middle_m;
  }
  return low_m;
}

// Turns a path of points into Gaussians. A vertex takes the smaller σ of its two legs. Where the
// leg from the start component would break δ, a round Gaussian at the start mean is inserted, so
// that the component contracts in place before it moves; likewise at the goal.
Waypoints CropsGuide::waypoints_along(const std::vector<std::uint32_t>& path, const Gaussian& start,
                                      const Gaussian& goal) const {
  std::vector<double> leg_sigma_m;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    leg_sigma_m.push_back(sigma_beside_m(points_m_[path[i]], points_m_[path[i + 1]]));
  }
  Waypoints middle;
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    middle.push_back(round_at(points_m_[path[i]], std::min(leg_sigma_m[i - 1], leg_sigma_m[i])));
  }
  EdgeChecker checker(*world_, risk_);
  Waypoints waypoints{start};
  const Gaussian& second = middle.empty() ? goal : middle.front();
  if (!checker.is_free(start, second, kPlanTolerance_m)) {
    waypoints.push_back(round_at(start.mean_m(), leg_sigma_m.front()));
  }
  waypoints.insert(waypoints.end(), middle.begin(), middle.end());
  if (!checker.is_free(waypoints.back(), goal, kPlanTolerance_m)) {
    waypoints.push_back(round_at(goal.mean_m(), leg_sigma_m.back()));
  }
  waypoints.push_back(goal);
  return waypoints;
}

std::optional<std::size_t> CropsGuide::route_near(const Vec2& at_m) const {
  double nearest_m = std::numeric_limits<double>::infinity();
  std::optional<std::size_t> nearest;
  for (std::size_t r = 0; r < routes_.size(); ++r) {
    for (const Gaussian& g : routes_[r].waypoints) {
      const double distance_m = (g.mean_m() - at_m).norm();
      if (distance_m >= nearest_m) continue;
      nearest_m = distance_m;
      nearest = r;
    }
  }
  return nearest;
}

// Raises the cost of the edges ahead of the stuck robots in both directions, then searches all
// paths again. The factors multiply when robots stay stuck there.
bool CropsGuide::reweight(std::size_t route, const Vec2& stuck_at_m) {
  SWARM_ASSERT(route < paths_.size());
  const std::vector<std::uint32_t> path = paths_[route];
  const std::size_t first = leg_at(path, points_m_, stuck_at_m);
  const std::size_t end = std::min(first + options_.stuck_edges, path.size() - 1);
  for (std::size_t i = first; i < end; ++i) {
    for (const auto& [from, to] : {std::pair{path[i], path[i + 1]}, {path[i + 1], path[i]}}) {
      for (std::uint32_t a = graph_.arc_offset[from]; a < graph_.arc_offset[from + 1]; ++a) {
        Roadmap::Arc& arc = graph_.arcs[a];
        if (arc.to != to) continue;
        arc.length_m = std::min(options_.stuck_factor * arc.length_m, kCostliest * first_cost_[a]);
      }
    }
  }
  const auto before = paths_;
  const bool solved = search();
  SWARM_ASSERT(solved);  // no edge was closed
  return paths_ != before;
}

Error CropsGuide::no_path() const {
  return {
      ErrorCode::kInfeasible,
      fmt::format("no path of the guide joins these start and goal components, and the swarm "
                  "cannot avoid them: {}; {} samples keep {} m, edges {} m from obstacles; "
                  "raise planner.samples or planner.connection_radius_m ({}), or open a passage",
                  unjoined_pairs(costs_, goals_.size()), points_m_.size() - terminals(),
                  options_.clearance_min_m, edge_clearance_m_, options_.connection_radius_m)};
}

}  // namespace swarm::planner
