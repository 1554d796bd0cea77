// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/tracking_charts.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "swarm_monitor/report/charts.hpp"

namespace swarm::monitor {
namespace {

/// Step of a chart's time axis [s]: one second, longer for long runs, so that a curve has at most
/// 2000 values.
template <class Moment>
double step_of(const std::vector<Moment>& moments) {
  constexpr double kMostValues = 2000.0;
  return std::max(1.0, moments.back().time_s / kMostValues);
}

/// A value for each step from 0 to the last moment: the value of the newest moment up to that time,
/// before the first moment that of the first one.
template <class Moment, class Of>
std::vector<double> by_step(const std::vector<Moment>& moments, Of of) {
  std::vector<double> values;
  const double step_s = step_of(moments);
  std::size_t k = 0;
  for (double t = 0.0; t <= moments.back().time_s; t += step_s) {
    while (k + 1 < moments.size() && moments[k + 1].time_s <= t) ++k;
    values.push_back(of(moments[k]));
  }
  return values;
}

/// Upper end of the value axis; never 0, which would make an empty axis.
double largest(std::span<const Curve> curves) {
  double most = 1e-3;
  for (const Curve& curve : curves) {
    for (const double value : curve.values) most = std::max(most, value);
  }
  return most;
}

std::string figure(std::string_view title, std::span<const Curve> curves, double step_s,
                   std::string_view unit, std::string_view caption) {
  return fmt::format("<figure><h2>{}</h2>\n{}<figcaption>{}</figcaption></figure>\n", title,
                     line_chart(curves, step_s, 1.02 * largest(curves), unit), caption);
}

std::string distance_figure(const Tracking& t) {
  const std::array<Curve, 2> curves{
      {{"swarm to plan",
        by_step(t.distances, [](const SwarmDistance& d) { return d.robots.w2_m; })},
       {"floor of sampling",
        by_step(t.distances, [](const SwarmDistance& d) { return d.robots.floor_m; })}}};
  return figure("Distance to the plan", curves, step_of(t.distances), "W2, m",
                fmt::format("W2 of the living robots to the mixture that is planned for the same "
                            "plan time, and of two samples of that mixture to each other: {:.2f} "
                            "times on average.",
                            t.w2->ratio()));
}

std::string lag_figure(const Tracking& t) {
  const auto& moments = t.own.moments;
  const std::array<Curve, 3> curves{
      {{"10 % of robots", by_step(moments, [](const LagMoment& m) { return m.p10_s; })},
       {"median", by_step(moments, [](const LagMoment& m) { return m.p50_s; })},
       {"90 %", by_step(moments, [](const LagMoment& m) { return m.p90_s; })}}};
  std::string caption =
      "How late robots pass the points of their own references; early is negative.";
  if (t.centre_lag_s) {
    caption += fmt::format(" The swarm's centre: {:.1f} s.", *t.centre_lag_s);
  }
  if (t.clock) {
    caption += fmt::format(" The plan's clock ran at {:.2f} on average, at {:.2f} at least.",
                           t.clock->rate_mean, t.clock->rate_min);
  }
  return figure("Lag", curves, step_of(moments), "s", caption);
}

std::string density_figure(const Tracking& t) {
  const auto& moments = t.density->moments;
  const std::array<Curve, 2> curves{
      {{"flown", by_step(moments, [](const DensityMoment& m) { return m.flown_per_m2; })},
       {"planned", by_step(moments, [](const DensityMoment& m) { return m.planned_per_m2; })}}};
  std::string caption =
      "Most robots in any disc of 2 m radius over its area, and the planned mean over the densest "
      "disc at the same plan time.";
  if (t.density->cap_per_m2) {
    caption += fmt::format(" The cap is {:g} per m².", *t.density->cap_per_m2);
  }
  return figure("Density", curves, step_of(moments), "robots per m²", caption);
}

}  // namespace

std::string tracking_figures(const Tracking& tracking) {
  std::string text;
  if (tracking.w2) text += distance_figure(tracking);
  if (!tracking.own.moments.empty()) text += lag_figure(tracking);
  if (tracking.density) text += density_figure(tracking);
  return text;
}

}  // namespace swarm::monitor
