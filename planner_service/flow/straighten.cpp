// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/straighten.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "planner_service/flow/density_grid.hpp"
#include "planner_service/flow/plan_density.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/squeeze.hpp"
#include "swarm_core/base/assert.hpp"
#include "swarm_core/gmm/same_gaussian.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

// Shares of the distance to the mean of the neighbours that are tried, the whole first.
constexpr std::array kStraightenSteps{1.0, 0.5, 0.25};
// Extra distances from obstacles that are tried [m]: at a corner the legs beside a node need more
// room than the node itself.
constexpr std::array kExtraRooms_m{0.0, 0.4, 1.0};
constexpr double kLater_s = 1e-9;              // rounding
constexpr double kCoarser = 2.0;               // every second time, until the whole is checked
constexpr double kStraightenBelowCap = 0.999;  // leaves the check of the whole little to undo

// √S = (S + √det I) / √(tr + 2√det), for a positive definite matrix of two rows.
Mat2 root_of(const Mat2& s) {
  const double root_det = std::sqrt(s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0));
  return (s + root_det * Mat2::Identity()) / std::sqrt(s.trace() + 2.0 * root_det);
}

// A plan with nodes in the middle of its longer legs, from `first_new` on: the same flow.
struct SplitPlan {
  FlowPlan plan;
  std::size_t first_new = 0;
  std::vector<bool> is_end;      // of nodes: they stay
  std::vector<bool> is_end_leg;  // of legs: they are timed for the robots of an ellipse
};

// Puts a node at the W₂ midpoint of each leg longer than longest_m, at its mid-time: the mixture at
// every time stays the same. Stops splitting where the plan would exceed its limits of size.
SplitPlan split(const FlowPlan& plan, const std::vector<bool>& is_end, double longest_m) {
  std::vector<PlanNode> nodes = plan.nodes();
  std::vector<PlanLeg> legs;
  SplitPlan result{{}, nodes.size(), is_end, {}};
  std::size_t legs_left = plan.legs().size();
  for (const PlanLeg& leg : plan.legs()) {
    const bool is_end_leg = is_end[leg.from] || is_end[leg.to];
    const PlanNode from = nodes[leg.from];
    const PlanNode to = nodes[leg.to];
    const bool fits =
        nodes.size() < FlowPlan::kMaxNodes && legs.size() + legs_left-- + 1 < FlowPlan::kMaxLegs;
    if (fits && (to.gaussian.mean_m() - from.gaussian.mean_m()).norm() > longest_m) {
      const auto middle = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back({Geodesic(from.gaussian, to.gaussian).at(0.5),
                       from.time + 0.5 * (to.time - from.time), leg.mass});
      result.is_end.push_back(false);
      legs.push_back({leg.from, middle, leg.mass});
      legs.push_back({middle, leg.to, leg.mass});
      result.is_end_leg.push_back(is_end_leg);
    } else {
      legs.push_back(leg);
    }
    result.is_end_leg.push_back(is_end_leg);
  }
  auto made = FlowPlan::make(std::move(nodes), std::move(legs));
  SWARM_ASSERT(made.has_value());
  result.plan = *std::move(made);
  return result;
}

// Block coordinate descent on the action Σ mass · W₂² / time: one Gaussian moves at a time, all
// times and masses stay. Every accepted move keeps speed, risk limit and density cap.
class Straightener {
 public:
  Straightener(const SplitPlan& split, const World& world, const RiskLimit& risk,
               const DensityCap& cap, const StraightenOptions& options, EdgeChecker& checker)
      : split_(split),
        nodes_(split.plan.nodes()),
        legs_of_(nodes_.size()),
        may_move_(nodes_.size(), true),
        is_straight_(nodes_.size(), false),
        world_(world),
        k_(cvar_coefficient(risk.alpha)),
        delta_m_(risk.delta_m),
        cap_(cap),
        options_(options),
        checker_(checker),
        density_(split.plan, cap.robots, kCoarser * options.sample_s) {
    for (std::uint32_t l = 0; l < split.plan.legs().size(); ++l) {
      legs_of_[leg(l).from].push_back(l);
      legs_of_[leg(l).to].push_back(l);
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i) may_move_[i] = !split.is_end[i];
  }

  // The straightened plan; nothing if no straightened plan keeps the cap at all times.
  std::optional<FlowPlan> run() {
    move_all();
    while (!keeps_cap()) {
    }
    if (has_failed_) return std::nullopt;
    const std::vector<PlanNode> bent = nodes_;
    drop_what_is_straight();
    for (;;) {
      FlowPlan plan = result();
      const std::vector<SharedPeak> peaks = peaks_of(plan);
      if (peaks.empty()) return plan;
      bend_again(peaks, bent);
    }
  }

 private:
  const PlanLeg& leg(std::uint32_t l) const { return split_.plan.legs()[l]; }
  double duration_s(const PlanLeg& leg) const {
    return (nodes_[leg.to].time - nodes_[leg.from].time).count();
  }
  std::uint32_t other_end(const PlanLeg& leg, std::uint32_t i) const {
    return leg.from == i ? leg.to : leg.from;
  }

  // Sweeps over the nodes in order of time. A node that could not move is skipped until a neighbour
  // moves.
  void move_all() {
    std::vector<std::uint32_t> order(nodes_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return nodes_[a].time < nodes_[b].time;
    });
    for (std::uint32_t sweep = 0; sweep < options_.sweeps; ++sweep) {
      bool some = false;
      for (const std::uint32_t i : order) {
        if (!may_move_[i]) continue;
        may_move_[i] = try_move(i);
        if (!may_move_[i]) continue;
        some = true;
        for (const std::uint32_t l : legs_of_[i]) {
          const std::uint32_t other = other_end(leg(l), i);
          may_move_[other] = !split_.is_end[other];
        }
      }
      if (!some) break;
      // Forth and back, so that what straightens reaches both ends of a route at once.
      std::reverse(order.begin(), order.end());
    }
  }

  // Action of the legs of node i if its Gaussian is g.
  double action(std::uint32_t i, const Gaussian& g) const {
    double sum = 0.0;
    for (const std::uint32_t l : legs_of_[i]) {
      const Gaussian& other = nodes_[other_end(leg(l), i)].gaussian;
      sum += leg(l).mass * wasserstein2_squared(g, other) / duration_s(leg(l));
    }
    return sum;
  }

  // The mean of the neighbours by mass over time: of means and of roots of covariances, which is
  // the W₂ mean where these commute.
  Gaussian middle_of(std::uint32_t i) const {
    double weights = 0.0;
    Vec2 mean_m = Vec2::Zero();
    Mat2 root = Mat2::Zero();
    for (const std::uint32_t l : legs_of_[i]) {
      const Gaussian& g = nodes_[other_end(leg(l), i)].gaussian;
      const double weight = leg(l).mass / duration_s(leg(l));
      weights += weight;
      mean_m += weight * g.mean_m();
      root += weight * root_of(g.covariance_m2());
    }
    root /= weights;
    return Gaussian::from_valid(mean_m / weights, root * root);
  }

  // Whether a leg between these Gaussians is no faster than allowed in the time it has. Legs at
  // start and goal components are also timed for the robots of the 2σ ellipse.
  bool is_slow_enough(std::uint32_t l, const Gaussian& from, const Gaussian& to,
                      double duration_s) const {
    const double least_s = split_.is_end_leg[l]
                               ? end_leg_duration_s(from, to, options_.speed)
                               : leg_duration_s(from, to, options_.speed.means_mps);
    return least_s <= duration_s + kLater_s;
  }

  // Whether all legs of a node keep the speed if its Gaussian is g.
  bool keeps_speed(std::uint32_t i, const Gaussian& g) const {
    return std::all_of(legs_of_[i].begin(), legs_of_[i].end(), [&](std::uint32_t l) {
      const bool leaves = leg(l).from == i;
      return is_slow_enough(l, leaves ? g : nodes_[leg(l).from].gaussian,
                            leaves ? nodes_[leg(l).to].gaussian : g, duration_s(leg(l)));
    });
  }
  // Whether all legs of a node are proven to keep the risk limit if its Gaussian is g.
  bool keeps_risk(std::uint32_t i, const Gaussian& g) const {
    EdgeEnd end(g);
    return std::all_of(legs_of_[i].begin(), legs_of_[i].end(), [&](std::uint32_t l) {
      EdgeEnd other(nodes_[other_end(leg(l), i)].gaussian);
      return checker_.is_free(end, other, kPlanTolerance_m);
    });
  }

  // Sets the Gaussian of a node if the density keeps the cap on its legs, else leaves it as it is.
  bool try_place(std::uint32_t i, const Gaussian& g) {
    const Gaussian before = std::exchange(nodes_[i].gaussian, g);
    if (density_.try_change(nodes_, legs_of_[i], kStraightenBelowCap * cap_.max_per_m2))
      return true;
    nodes_[i].gaussian = before;
    return false;
  }

  // Line search towards the mean of the neighbours. Each candidate is first made feasible (pushed
  // out of obstacles, then squeezed); the cheap tests come before the proof of the edges and the
  // density.
  bool try_move(std::uint32_t i) {
    const double enough = (1.0 - options_.worthwhile) * action(i, nodes_[i].gaussian);
    const Geodesic path(nodes_[i].gaussian, middle_of(i));
    // Slightly more than σ_min needs, so that the squeeze that follows does not end below it.
    const double room_m = k_ * options_.sigma_min_m * (1.0 + 1e-6) - delta_m_;
    for (const double step : kStraightenSteps) {
      for (const double extra_m : kExtraRooms_m) {
        const std::optional<Gaussian> moved =
            squeeze_into_free(push_out(path.at(step), world_, room_m + extra_m), world_, k_,
                              delta_m_ - extra_m, options_.sigma_min_m);
        if (!moved || action(i, *moved) >= enough) continue;
        if (!keeps_speed(i, *moved) || !keeps_risk(i, *moved)) continue;
        if (try_place(i, *moved)) return true;
      }
    }
    return false;
  }

  std::vector<SharedPeak> peaks_of(const FlowPlan& plan) const {
    return peaks_above(plan, cap_.robots, options_.sample_s, cap_.max_per_m2);
  }

  // Whether the whole plan keeps the cap; if not, nodes beside the peaks are put back, those with a
  // large share of a peak first.
  bool keeps_cap() {
    auto made = FlowPlan::make(nodes_, split_.plan.legs());
    SWARM_ASSERT(made.has_value());
    const std::vector<SharedPeak> peaks = peaks_of(*made);
    if (peaks.empty()) return true;
    constexpr double kShareThatCounts = 0.02;
    if (undo_beside(peaks, kShareThatCounts) || undo_beside(peaks, 0.0)) return false;
    has_failed_ = true;  // at times between those at which the plan was checked before
    return true;
  }

  bool undo_beside(const std::vector<SharedPeak>& peaks, double share_that_counts);

  // A new node whose neighbours can be joined directly is not needed: it is put on the leg between
  // them and left out of the result. Its neighbours are nodes of the plan, which stay.
  void drop_what_is_straight() {
    density_ = DensityGrid(FlowPlan::make(nodes_, split_.plan.legs()).value(), cap_.robots,
                           kCoarser * options_.sample_s);
    for (auto i = static_cast<std::uint32_t>(split_.first_new); i < nodes_.size(); ++i) {
      const std::uint32_t in = legs_of_[i][0];
      const std::uint32_t out = legs_of_[i][1];
      const Gaussian& from = nodes_[leg(in).from].gaussian;
      const Gaussian& to = nodes_[leg(out).to].gaussian;
      if (!is_slow_enough(in, from, to, duration_s(leg(in)) + duration_s(leg(out))) ||
          !checker_.is_free(from, to, kPlanTolerance_m)) {
        continue;
      }
      is_straight_[i] = try_place(i, Geodesic(from, to).at(0.5));
    }
  }

  // Takes back new nodes that were dropped from legs beside peaks, or all of them when none is
  // beside a peak. The loop in run() ends, because the plan with no node dropped keeps the cap.
  void bend_again(const std::vector<SharedPeak>& peaks, const std::vector<PlanNode>& bent) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> legs;
    for (const SharedPeak& peak : peaks) {
      for (const DensityShare& share : peak.shares) legs.insert({share.from, share.to});
    }
    const auto take_back = [&](bool all) {
      bool some = false;
      for (std::size_t i = split_.first_new; i < nodes_.size(); ++i) {
        const bool is_beside = legs.contains({leg(legs_of_[i][0]).from, leg(legs_of_[i][1]).to});
        if (!is_straight_[i] || !(all || is_beside)) continue;
        is_straight_[i] = false;
        nodes_[i] = bent[i];
        some = true;
      }
      return some;
    };
    if (!take_back(false)) take_back(true);
  }

  FlowPlan result() const;

  const SplitPlan& split_;
  std::vector<PlanNode> nodes_;
  std::vector<std::vector<std::uint32_t>> legs_of_;  // of each node; a new one's: in, out
  std::vector<bool> may_move_;                       // something beside it has changed
  std::vector<bool> is_straight_;                    // a new node that is not needed
  bool has_failed_ = false;
  const World& world_;
  double k_;
  double delta_m_;
  DensityCap cap_;
  StraightenOptions options_;
  EdgeChecker& checker_;
  DensityGrid density_;
};

/// Puts nodes beside peaks back to their Gaussians in the plan before. False when all are there
/// already.
bool Straightener::undo_beside(const std::vector<SharedPeak>& peaks, double share_that_counts) {
  std::vector<std::uint32_t> open;
  for (const SharedPeak& peak : peaks) {
    for (const DensityShare& share : peak.shares) {
      if (share.per_m2 < share_that_counts * peak.peak.per_m2) continue;
      open.push_back(share.from);
      open.push_back(share.to);
    }
  }
  bool some = false;
  while (!open.empty()) {
    const std::uint32_t i = open.back();
    open.pop_back();
    const Gaussian& was = split_.plan.nodes()[i].gaussian;
    if (same(nodes_[i].gaussian, was)) continue;
    nodes_[i].gaussian = was;
    some = true;
    // Neighbours that can no longer be joined to the old Gaussian are put back as well.
    for (const std::uint32_t l : legs_of_[i]) {
      const Gaussian& from = nodes_[leg(l).from].gaussian;
      const Gaussian& to = nodes_[leg(l).to].gaussian;
      if (!is_slow_enough(l, from, to, duration_s(leg(l))) ||
          !checker_.is_free(from, to, kPlanTolerance_m)) {
        open.push_back(other_end(leg(l), i));
      }
    }
  }
  return some;
}

/// The plan without the nodes that are not needed; the two legs of each become one.
FlowPlan Straightener::result() const {
  std::vector<std::uint32_t> index(nodes_.size(), 0);
  std::vector<PlanNode> nodes;
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    index[i] = static_cast<std::uint32_t>(nodes.size());
    if (!is_straight_[i]) nodes.push_back(nodes_[i]);
  }
  std::vector<PlanLeg> legs;
  for (std::uint32_t l = 0; l < split_.plan.legs().size(); ++l) {
    if (is_straight_[leg(l).from]) continue;
    const std::uint32_t to = is_straight_[leg(l).to] ? leg(legs_of_[leg(l).to][1]).to : leg(l).to;
    legs.push_back({index[leg(l).from], index[to], leg(l).mass});
  }
  auto made = FlowPlan::make(std::move(nodes), std::move(legs));
  SWARM_ASSERT(made.has_value());
  return *std::move(made);
}

}  // namespace

FlowPlan straighten(const FlowPlan& plan, const std::vector<bool>& is_end, const World& world,
                    const RiskLimit& risk, const DensityCap& cap, const StraightenOptions& options,
                    EdgeChecker& checker) {
  SWARM_ASSERT(is_end.size() == plan.nodes().size() && options.split_m > 0.0);
  const SplitPlan halves = split(plan, is_end, options.split_m);
  return Straightener(halves, world, risk, cap, options, checker).run().value_or(plan);
}

}  // namespace swarm::planner
