// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/tracking_json.hpp"

#include <cmath>

#include <fmt/format.h>

namespace swarm::monitor {
namespace {

using Json = nlohmann::ordered_json;

/// What was not measured becomes null, never 0.
Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

/// W2, its floor and their ratio, the number to judge by.
Json distance(const std::optional<Distance>& d) {
  if (!d) return nullptr;
  return {{"w2_m", d->w2_m}, {"floor_m", d->floor_m}, {"ratio", d->ratio()}};
}

Json plans(const std::vector<PlanDistance>& by_plan) {
  Json list = Json::array();
  for (const PlanDistance& plan : by_plan) {
    Json entry = {{"plan_version", plan.plan_version}, {"moments", plan.moments}};
    entry.update(distance(plan.mean));
    list.push_back(entry);
  }
  return list;
}

Json clock(const Tracking& tracking) {
  if (!tracking.clock) return nullptr;
  const ClockUse& use = *tracking.clock;
  return {{"covered_share", use.covered_share},
          {"rate_mean", use.rate_mean},
          {"rate_min", use.rate_min},
          {"slowed_share", use.slowed_share},
          {"error_s", number(tracking.own.clock_error_s)}};
}

/// Quantiles of the signed lag; `amount_` ones are those of its absolute value.
Json lag(const std::optional<LagQuantiles>& q) {
  if (!q) return nullptr;
  return {{"p1", q->p1_s},
          {"p10", q->p10_s},
          {"p50", q->p50_s},
          {"p90", q->p90_s},
          {"p99", q->p99_s},
          {"amount_p90", q->amount_p90_s},
          {"amount_p99", q->amount_p99_s}};
}

Json reference(const std::optional<ReferenceError>& e) {
  if (!e) return nullptr;
  return {{"p50", e->p50_m}, {"p95", e->p95_m}, {"rms", e->rms_m}};
}

Json density(const std::optional<DensityCourse>& d) {
  if (!d) return nullptr;
  return {{"worst", d->worst_per_m2},
          {"p95", d->p95_per_m2},
          {"planned_worst", d->planned_worst_per_m2},
          {"cap", number(d->cap_per_m2)},
          {"over_cap_p95", number(d->over_cap(d->p95_per_m2))},
          {"over_cap_worst", number(d->over_cap(d->worst_per_m2))},
          {"planned_over_cap", number(d->over_cap(d->planned_worst_per_m2))},
          {"crowded_share", number(d->dense_share)}};
}

Json risk(const std::optional<ExecutedRisk>& r) {
  if (!r) return nullptr;
  return {{"worst", r->worst_m},
          {"planned_worst", r->planned_worst_m},
          {"kept_share", r->kept_share},
          {"most_over_plan", number(r->most_over_plan_m)},
          {"filter_alone", r->filter_m}};
}

/// `own_place` is the robot's own slot: the last reference that it logged.
Json ending(const Ending& e) {
  return {{"to_goal", distance(e.to_goal)},
          {"references_to_goal", distance(e.references_to_goal)},
          {"own_place_share", number(e.own_place_share)},
          {"own_place_1m_share", number(e.own_place_wide_share)}};
}

std::string distance_text(const Distance& d) {
  return fmt::format("{:.2f} m, {:.2f} times the floor {:.2f} m", d.w2_m, d.ratio(), d.floor_m);
}

/// One decimal, without the sign of values that round to 0.
std::string tenths(double value) {
  const double rounded = std::round(10.0 * value) / 10.0;
  return fmt::format("{:.1f}", rounded == 0.0 ? 0.0 : rounded);
}

}  // namespace

/// The object `tracking` of the audit; docs/audit.md defines every quantity.
Json tracking_json(const Tracking& tracking) {
  return {{"swarm", distance(tracking.w2)},
          {"moments", tracking.distances.size()},
          {"swarm_half", distance(tracking.w2_half)},
          {"references", distance(tracking.references)},
          {"plans", plans(tracking.plans)},
          {"clock", clock(tracking)},
          {"centre_lag_s", number(tracking.centre_lag_s)},
          {"lag_s", lag(tracking.own.lag)},
          {"own_reference_m", reference(tracking.own.error)},
          {"followed_share", tracking.own.followed_share},
          {"density_per_m2", density(tracking.density)},
          {"cvar_m", risk(tracking.risk)},
          {"end", ending(tracking.ending)},
          {"plan_s", number(tracking.plan_s)},
          {"mission_over_plan_s", number(tracking.mission_over_plan_s)},
          {"arrival_spread_s", number(tracking.arrival_spread_s)}};
}

std::string tracking_text(const Tracking& tracking) {
  std::string text;
  const auto add = [&](const char* what, const std::string& value) {
    text += fmt::format("  {:<16} {}\n", what, value);
  };
  if (tracking.w2) {
    add("W2 to the plan",
        distance_text(*tracking.w2) + " (floor: W2 of two random samples of the plan)");
  }
  if (tracking.w2_half && tracking.plans.size() > 1) {
    add("  half under way", distance_text(*tracking.w2_half));
  }
  if (tracking.centre_lag_s) {
    std::string lag = fmt::format("{} s of the centre", tenths(*tracking.centre_lag_s));
    if (const auto& q = tracking.own.lag) {
      lag += fmt::format(", robots {} (p10), {} (p90), {} (p99)", tenths(q->p10_s),
                         tenths(q->p90_s), tenths(q->p99_s));
    }
    add("lag", lag);
  }
  if (const auto& e = tracking.own.error) {
    add("off reference",
        fmt::format("{:.2f} m (p50), {:.2f} (p95), {:.2f} (rms)", e->p50_m, e->p95_m, e->rms_m));
  }
  if (const auto& d = tracking.density) {
    std::string density = fmt::format("{:.2f} robots/m2 (p95), {:.2f} (worst), planned {:.2f}",
                                      d->p95_per_m2, d->worst_per_m2, d->planned_worst_per_m2);
    if (d->cap_per_m2) density += fmt::format(", cap {:.2f}", *d->cap_per_m2);
    add("density", density);
  }
  if (const auto& r = tracking.risk) {
    add("CVaR executed",
        fmt::format("{:.2f} m (worst), planned {:.2f}, limit kept {:.1f} % of the time", r->worst_m,
                    r->planned_worst_m, 100.0 * r->kept_share));
  }
  const Ending& end = tracking.ending;
  if (end.to_goal) add("W2 to the goal", distance_text(*end.to_goal));
  if (end.own_place_share) {
    add("in own slot",
        fmt::format("{:.1f} % within 0.7 m, {:.1f} % within 1 m", 100.0 * *end.own_place_share,
                    100.0 * *end.own_place_wide_share));
  }
  return text;
}

}  // namespace swarm::monitor
