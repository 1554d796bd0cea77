// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/centre_lag.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "swarm_monitor/audit/tracking/swarm_walk.hpp"

namespace swarm::monitor {
namespace {

/// Resolution of the lag, spacing of the table of means, and its largest size [s, s, entries].
constexpr double kStep_s = 0.05;
constexpr double kTable_s = 0.25;
constexpr double kMostEntries = 20'000;  // a plan of more than 5000 s has a coarser table
/// Sums of squares closer than this share count as equal, so that a plan at rest, for which every
/// shift is as good, gives the smallest shift and not one chosen by rounding.
constexpr double kSame = 1e-9;

/// The plan's mean over plan time, tabulated once per plan and linear between entries: the search
/// evaluates it for 2400 shifts at every moment, and a plan may have hundreds of legs.
class MeanTable {
 public:
  explicit MeanTable(const FlowPlan& plan) {
    const double duration_s = std::max(0.0, plan.duration().count());
    step_s_ = std::max(kTable_s, duration_s / kMostEntries);
    const auto steps = static_cast<std::size_t>(std::ceil(duration_s / step_s_)) + 1;
    for (std::size_t k = 0; k < steps; ++k) {
      means_.push_back(plan_mean(plan, static_cast<double>(k) * step_s_));
    }
  }
  Vec2 at(double plan_time_s) const {
    const double entry =
        std::clamp(plan_time_s / step_s_, 0.0, static_cast<double>(means_.size() - 1));
    const auto k = std::min(static_cast<std::size_t>(entry), means_.size() - 1);
    const Vec2& next = means_[std::min(k + 1, means_.size() - 1)];
    return means_[k] + (entry - static_cast<double>(k)) * (next - means_[k]);
  }

 private:
  double step_s_ = kTable_s;
  std::vector<Vec2> means_;
};

/// The swarm's centre at one moment, with the plan and the plan time that were in force.
struct Centre {
  const MeanTable* plan;
  double plan_time_s;
  Vec2 at_m;
};

}  // namespace

/// Mass-weighted mean of the mixture: sources wait at their mean until they start, mass on a leg
/// moves linearly between the means of its ends (the mean of the W₂ geodesic), and sinks hold
/// theirs after arrival. The masses add up to 1 except for rounding, hence the division.
Vec2 plan_mean(const FlowPlan& plan, double plan_time_s) {
  const MissionTime t(plan_time_s);
  const auto& nodes = plan.nodes();
  Vec2 sum = Vec2::Zero();
  double mass = 0.0;
  const auto add = [&](double m, const Vec2& at) {
    sum += m * at;
    mass += m;
  };
  for (const std::uint32_t i : plan.sources()) {
    if (t < nodes[i].time) add(nodes[i].mass, nodes[i].gaussian.mean_m());
  }
  for (const PlanLeg& leg : plan.legs()) {
    const PlanNode& from = nodes[leg.from];
    const PlanNode& to = nodes[leg.to];
    if (t < from.time || t >= to.time) continue;
    const double share = (t - from.time) / (to.time - from.time);
    add(leg.mass, from.gaussian.mean_m() + share * (to.gaussian.mean_m() - from.gaussian.mean_m()));
  }
  for (const std::uint32_t i : plan.sinks()) {
    if (t >= nodes[i].time) add(nodes[i].mass, nodes[i].gaussian.mean_m());
  }
  return sum / mass;
}

/// Brute force over the shifts in order of their size: the sum of squares has several local minima
/// where a plan turns back, so a descent would not do.
std::optional<double> centre_lag_s(const RecordedRun& run, std::span<const PlanMoment> moments) {
  std::map<std::uint32_t, MeanTable> tables;
  std::vector<Centre> centres;
  SwarmWalk walk(run.tracks);
  for (const PlanMoment& moment : moments) {
    const std::vector<RobotNow>& living = walk.at(moment.time_s);
    if (living.empty()) continue;
    const auto table = tables.try_emplace(moment.published->version, moment.published->plan).first;
    Vec2 centre = Vec2::Zero();
    for (const RobotNow& robot : living) {
      centre += robot.position_m / static_cast<double>(living.size());
    }
    centres.push_back({&table->second, moment.plan_time_s, centre});
  }
  if (centres.empty()) return std::nullopt;
  const auto squares_at = [&](double lag_s) {
    double squares = 0.0;
    for (const Centre& c : centres) {
      squares += (c.at_m - c.plan->at(c.plan_time_s - lag_s)).squaredNorm();
    }
    return squares;
  };
  double best_s = 0.0;
  double least = squares_at(0.0);
  // From small to large shifts, so that among equally good ones the smallest is kept.
  const auto shifts = static_cast<int>(std::lround(kMostCentreLag_s / kStep_s));
  for (int k = 1; k <= shifts; ++k) {
    for (const double lag_s : {k * kStep_s, -k * kStep_s}) {
      const double squares = squares_at(lag_s);
      if (squares >= least * (1.0 - kSame)) continue;
      least = squares;
      best_s = lag_s;
    }
  }
  return best_s;
}

}  // namespace swarm::monitor
