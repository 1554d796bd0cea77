// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/criteria.hpp"

#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace swarm::monitor {
namespace {

using Value = std::optional<double>;

/// W2 over its floor; empty if it was not measured.
Value ratio_of(const std::optional<Distance>& distance) {
  return distance ? Value(distance->ratio()) : std::nullopt;
}

/// A member of a result that may not have been measured.
template <class Whole, class Member>
Value member(const std::optional<Whole>& whole, Member Whole::*of) {
  return whole ? Value((*whole).*of) : std::nullopt;
}

/// Compares values with the bars of the mission and keeps a line for each bar that is missed. A bar
/// that the mission does not set is skipped.
class Judge {
 public:
  void at_most(std::string_view key, const Value& bar, const Value& value, std::string_view what,
               std::string_view unit, const std::string& no_evidence) {
    judge(key, bar, value, what, unit, no_evidence, true);
  }
  void at_least(std::string_view key, const Value& bar, const Value& value, std::string_view what,
                const std::string& no_evidence) {
    judge(key, bar, value, what, "", no_evidence, false);
  }
  std::vector<std::string> take() { return std::move(reasons_); }

 private:
  // A bar whose value was not measured, or is not finite, is missed: a run must not pass for lack
  // of evidence.
  void judge(std::string_view key, const Value& bar, const Value& value, std::string_view what,
             std::string_view unit, const std::string& no_evidence, bool most) {
    if (!bar) return;
    if (!no_evidence.empty() || !value || !std::isfinite(*value)) {
      reasons_.push_back(fmt::format("{}: not measured: {}", key,
                                     no_evidence.empty() ? "the run shows none" : no_evidence));
      return;
    }
    if (most ? *value <= *bar : *value >= *bar) return;
    reasons_.push_back(fmt::format("{} is {:.4g}{}; must be {} {:g} ({})", what, *value, unit,
                                   most ? "<=" : ">=", *bar, key));
  }

  std::vector<std::string> reasons_;
};

/// Criteria of single robots against their own references.
void judge_robots(const CriteriaSpec& c, const Tracking& t, const std::string& no_clock,
                  const std::string& no_references, Judge& judge) {
  judge.at_most("lag_p90_max_s", c.lag_p90_max_s, member(t.own.lag, &LagQuantiles::amount_p90_s),
                "amount of the robots' lag at 90 %", " s", no_references);
  judge.at_most("lag_p99_max_s", c.lag_p99_max_s, member(t.own.lag, &LagQuantiles::amount_p99_s),
                "amount of the robots' lag at 99 %", " s", no_references);
  judge.at_most("clock_error_max_s", c.clock_error_max_s, t.own.clock_error_s,
                "difference of a robot's plan time to the published one", " s", no_clock);
  judge.at_most("reference_p50_max_m", c.reference_p50_max_m,
                member(t.own.error, &ReferenceError::p50_m),
                "median distance of robots to their references", " m", no_references);
  judge.at_most("reference_p95_max_m", c.reference_p95_max_m,
                member(t.own.error, &ReferenceError::p95_m),
                "distance of robots to their references at 95 %", " m", no_references);
  judge.at_most("reference_rms_max_m", c.reference_rms_max_m,
                member(t.own.error, &ReferenceError::rms_m),
                "rms distance of robots to their references", " m", no_references);
}

}  // namespace

/// One call per key of the mission's criteria. Each names the reason why its quantity could not be
/// measured: without the published clock nothing of the plan's time can be judged, and without
/// truthful references nothing of the robots' own ones.
std::vector<std::string> failed_criteria(const CriteriaSpec& criteria, const Tracking& tracking,
                                         std::optional<double> path_ratio) {
  const CriteriaSpec& c = criteria;
  const Tracking& t = tracking;
  const std::string no_clock = t.no_clock();
  const std::string no_references = t.no_references();
  const std::string no_cap = !no_clock.empty() || (t.density && t.density->cap_per_m2)
                                 ? no_clock
                                 : "the mission has no density cap";
  // The own-slot criterion additionally needs last references that sample the goal: otherwise
  // robots could log the positions where they happened to stop.
  const auto& last = t.ending.references_to_goal;
  const std::string no_slots =
      no_references.empty() && last && last->ratio() > Tracking::kTruthfulRatio
          ? fmt::format("the last references are not the goal's: W2 {:.2f} m, floor {:.2f}",
                        last->w2_m, last->floor_m)
          : no_references;
  const auto over_cap = [&](double DensityCourse::*peak) {
    return t.density ? t.density->over_cap((*t.density).*peak) : std::nullopt;
  };
  Judge judge;
  judge.at_most("w2_ratio_max", c.w2_ratio_max, ratio_of(t.w2),
                "W2 of the swarm to the plan's mixture over its floor", "", no_clock);
  judge.at_most("w2_half_ratio_max", c.w2_half_ratio_max, ratio_of(t.w2_half),
                "W2 to the plan's mixture over its floor while half are under way", "", no_clock);
  judge.at_most("w2_end_ratio_max", c.w2_end_ratio_max, ratio_of(t.ending.to_goal),
                "W2 of the last positions to the goal over its floor", "", "");
  // The amount of the lag is judged; the text states its sign.
  const bool early = t.centre_lag_s.value_or(0.0) < 0.0;
  judge.at_most("centre_lag_max_s", c.centre_lag_max_s,
                t.centre_lag_s ? Value(std::abs(*t.centre_lag_s)) : std::nullopt,
                early ? "earliness of the swarm's centre" : "lag of the swarm's centre", " s",
                no_clock);
  judge_robots(c, t, no_clock, no_references, judge);
  judge.at_most("density_over_cap_p95_max", c.density_over_cap_p95_max,
                over_cap(&DensityCourse::p95_per_m2), "flown peak density over the cap at 95 %", "",
                no_cap);
  judge.at_most("density_over_cap_max", c.density_over_cap_max,
                over_cap(&DensityCourse::worst_per_m2), "flown peak density over the cap", "",
                no_cap);
  judge.at_most("planned_over_cap_max", c.planned_over_cap_max,
                over_cap(&DensityCourse::planned_worst_per_m2), "planned peak density over the cap",
                "", no_cap);
  judge.at_least("cvar_kept_share_min", c.cvar_kept_share_min,
                 member(t.risk, &ExecutedRisk::kept_share),
                 "share of the time with the CVaR kept in flight", no_clock);
  judge.at_least("own_place_share_min", c.own_place_share_min, t.ending.own_place_share,
                 "share of robots at their own place", no_slots);
  judge.at_most("path_ratio_max", c.path_ratio_max, path_ratio, "mean path over the geodesic bound",
                "", "");
  judge.at_most("mission_over_plan_max_s", c.mission_over_plan_max_s, t.mission_over_plan_s,
                "mission time beyond the plan's duration", " s", "");
  judge.at_most("arrival_spread_max_s", c.arrival_spread_max_s, t.arrival_spread_s,
                "spread of the arrival times, 5 % to 95 %,", " s", "");
  return judge.take();
}

}  // namespace swarm::monitor
