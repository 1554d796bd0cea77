// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/flow_groups.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "planner_service/groups/group_shape.hpp"
#include "planner_service/methods/rover/measured_state.hpp"
#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarm_core/risk/mixture_cvar.hpp"

namespace swarm::planner {
namespace {

// Robots that become one group, with the Gaussian of their positions.
struct Cluster {
  Members members;
  Gaussian gaussian;
};

// The groups in the making: divided until each is narrow and clear, then joined where near.
class Clusters {
 public:
  Clusters(const World& world, const FlowGroupOptions& options)
      : world_(world), options_(options) {}

  void add(Members members) {
    const Gaussian shape = shape_of(members, options_.sigma_floor_m);
    clusters_.push_back({std::move(members), shape});
  }

  /// Divides groups that are too wide, or have their mean too near an obstacle, down to single
  /// robots.
  void divide() {
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
      // Halves at the median along the longer axis, so that both parts are narrower.
      while (clusters_[i].members.size() > 1 && !fits(clusters_[i].gaussian)) {
        const Cluster whole = clusters_[i];
        Members ordered = whole.members;
        sort_along_axis(ordered, whole.gaussian);
        const auto middle = ordered.begin() + static_cast<std::ptrdiff_t>(ordered.size() / 2);
        add({middle, ordered.end()});
        ordered.erase(middle, ordered.end());
        clusters_[i] = {ordered, shape_of(ordered, options_.sigma_floor_m)};
      }
    }
  }

  /// Joins the nearest two while they are near or there are too many.
  void join() {
    for (;;) {
      const bool too_many = clusters_.size() > options_.groups_max;
      // While there are too many groups any pair may be joined, however far apart.
      double nearest_m = too_many ? std::numeric_limits<double>::infinity() : options_.join_m;
      std::size_t first = 0;
      std::size_t second = 0;
      Cluster joined;
      for (std::size_t i = 0; i < clusters_.size(); ++i) {
        for (std::size_t j = i + 1; j < clusters_.size(); ++j) {
          const double w2_m = wasserstein2(clusters_[i].gaussian, clusters_[j].gaussian);
          if (w2_m >= nearest_m) continue;
          Members both = clusters_[i].members;
          both.insert(both.end(), clusters_[j].members.begin(), clusters_[j].members.end());
          const Gaussian shape = shape_of(both, options_.sigma_floor_m);
          if (!fits(shape) && !too_many) continue;
          if (!is_clear(shape)) continue;
          nearest_m = w2_m;
          first = i;
          second = j;
          joined = {std::move(both), shape};
        }
      }
      if (second == 0) return;
      clusters_[first] = std::move(joined);
      clusters_.erase(clusters_.begin() + static_cast<std::ptrdiff_t>(second));
    }
  }

  const std::vector<Cluster>& all() const { return clusters_; }

 private:
  bool is_clear(const Gaussian& g) const {
    return world_.is_clear(g.mean_m(), options_.clearance_m);
  }
  // Whether a group may stay whole: narrow enough, and its mean clear of obstacles.
  bool fits(const Gaussian& g) const {
    return g.max_sigma_m() <= options_.sigma_max_m && is_clear(g);
  }

  const World& world_;
  const FlowGroupOptions& options_;
  std::vector<Cluster> clusters_;
};

/// Each robot with the component it most likely belongs to.
std::map<std::size_t, Members> most_likely(const RiskGraph& graph, const Members& robots) {
  std::map<std::size_t, Members> by_component;
  if (robots.empty()) return by_component;
  std::vector<Vec2> positions_m;
  for (const ReportedRobot* robot : robots) positions_m.push_back(robot->position_m);
  const Mixture mixture = measured_mixture(graph, positions_m);
  for (const ReportedRobot* robot : robots) {
    std::size_t likeliest = 0;
    double best = -1.0;
    for (std::size_t j = 0; j < mixture.components().size(); ++j) {
      const WeightedGaussian& c = mixture.components()[j];
      const double density = c.weight * c.gaussian.density(robot->position_m);
      if (density <= best) continue;
      best = density;
      likeliest = j;
    }
    by_component[likeliest].push_back(robot);
  }
  return by_component;
}

}  // namespace

// Groups of arrived robots come first and are neither divided nor joined: they have to stay exactly
// at the Gaussians of the goal.
std::vector<RobotGroup> group_by_flow(std::span<const ReportedRobot> robots, const RiskGraph& graph,
                                      const Mixture& goal, const FlowGroupOptions& options) {
  SWARM_ASSERT(!robots.empty());
  std::map<std::uint32_t, Members> at_goal, on_leg;
  Members elsewhere;
  for (const ReportedRobot& robot : robots) {
    if (robot.arrived && robot.goal) {
      at_goal[*robot.goal].push_back(&robot);
    } else if (robot.leg) {
      on_leg[*robot.leg].push_back(&robot);
    } else {
      elsewhere.push_back(&robot);
    }
  }
  Clusters clusters(graph.world(), options);
  for (auto& [leg, members] : on_leg) clusters.add(std::move(members));
  for (auto& [component, members] : most_likely(graph, elsewhere)) {
    clusters.add(std::move(members));
  }
  clusters.divide();
  clusters.join();
  std::vector<RobotGroup> groups;
  for (const auto& [component, members] : at_goal) {
    groups.push_back({goal.components()[component].gaussian, ids_of(members)});
  }
  for (const Cluster& cluster : clusters.all()) {
    groups.push_back({cluster.gaussian, ids_of(cluster.members)});
  }
  return groups;
}

// Rounds the goal weights to whole robots by largest remainders, components that already have more
// robots than their share first. Other roundings are tried in order of preference, at most kTries,
// until one keeps (11g).
Mixture goal_in_robots(const Mixture& goal, std::span<const std::size_t> led, std::size_t robots,
                       const World& world, const RiskLimit& risk) {
  constexpr std::size_t kTries = 64;
  const std::size_t count = goal.components().size();
  SWARM_ASSERT(led.size() == count && robots > 0);
  double total = 0.0;
  for (const WeightedGaussian& c : goal.components()) total += c.weight;
  std::vector<std::size_t> whole(count);
  std::vector<double> wanted(count);  // of another robot, beyond the whole number below
  std::size_t left = robots;
  for (std::size_t j = 0; j < count; ++j) {
    const double exact = goal.components()[j].weight / total * static_cast<double>(robots);
    whole[j] = static_cast<std::size_t>(exact + 1e-9);
    left -= std::min(left, whole[j]);
    // Components that are assigned more robots than that already come first.
    wanted[j] = exact - static_cast<double>(whole[j]) + (led[j] > whole[j] ? 1.0 : 0.0);
  }
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return wanted[a] > wanted[b]; });
  // Which of them get one more: the most wanted first, then the other choices.
  std::vector<std::uint8_t> more(count, 0);
  std::fill_n(more.begin(), std::min(left, count), std::uint8_t{1});
  for (std::size_t tries = 0; tries < kTries; ++tries) {
    std::vector<WeightedGaussian> components;
    std::vector<std::size_t> rounded = whole;
    for (std::size_t i = 0; i < count; ++i) rounded[order[i]] += more[i];
    for (std::size_t j = 0; j < count; ++j) {
      if (rounded[j] == 0) return goal;  // too few robots for all components
      components.push_back({static_cast<double>(rounded[j]) / static_cast<double>(robots),
                            goal.components()[j].gaussian});
    }
    auto mixture = Mixture::make(std::move(components));
    SWARM_ASSERT(mixture.has_value());
    if (max_mixture_cvar_m(*mixture, world, risk.alpha) <= risk.delta_m) return *std::move(mixture);
    if (!std::prev_permutation(more.begin(), more.end())) break;
  }
  return goal;
}

}  // namespace swarm::planner
