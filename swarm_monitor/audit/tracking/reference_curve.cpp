// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/reference_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "swarm_core/base/assert.hpp"

namespace swarm::monitor {
namespace {

/// Distances closer than this are equal: references are logged as floats, which resolve about 1e-5
/// m on maps of 100 m.
constexpr double kSame_m = 1e-4;
/// The speed at an end of the curve is the mean over this time.
constexpr double kEndSpeedOver_s = 1.0;
/// Whether a reference waits is judged by its motion this far before and after τ.
constexpr double kAround_s = 0.5;

}  // namespace

/// Keeps entries at least kSpacing_s apart in τ: a paused plan clock repeats its time, and a curve
/// needs ascending times.
void ReferenceCurve::add(double plan_time_s, const Vec2& reference_m) {
  if (!entries_.empty() && plan_time_s < entries_.back().plan_time_s + kSpacing_s) return;
  entries_.push_back({plan_time_s, reference_m});
}

std::pair<ReferenceCurve::Entry, ReferenceCurve::Entry> ReferenceCurve::piece(std::size_t k) const {
  if (k > 0 && k < entries_.size()) return {entries_[k - 1], entries_[k]};
  // Beyond an end: on at the mean speed over the time next to it.
  const bool front = k == 0;
  const Entry& end = front ? entries_.front() : entries_.back();
  const double inner_s = end.plan_time_s + (front ? kEndSpeedOver_s : -kEndSpeedOver_s);
  const auto inside = [&](const Entry& e) {
    return front ? e.plan_time_s >= inner_s : e.plan_time_s <= inner_s;
  };
  const Entry* inner = front ? &entries_.back() : &entries_.front();
  if (front) {
    const auto it = std::find_if(entries_.begin(), entries_.end(), inside);
    if (it != entries_.end()) inner = &*it;
  } else {
    const auto it = std::find_if(entries_.rbegin(), entries_.rend(), inside);
    if (it != entries_.rend()) inner = &*it;
  }
  Entry far{end.plan_time_s + (front ? -kBeyond_s : kBeyond_s), end.at_m};
  if (inner->plan_time_s != end.plan_time_s) {
    const Vec2 velocity_mps = (inner->at_m - end.at_m) / (inner->plan_time_s - end.plan_time_s);
    far.at_m += (far.plan_time_s - end.plan_time_s) * velocity_mps;
  }
  return front ? std::pair(far, end) : std::pair(end, far);
}

/// Linear in the piece that holds τ; clamped beyond the extrapolated ends.
Vec2 ReferenceCurve::at(double plan_time_s) const {
  SWARM_ASSERT(!empty());
  const auto after = std::upper_bound(entries_.begin(), entries_.end(), plan_time_s,
                                      [](double t, const Entry& e) { return t < e.plan_time_s; });
  const auto [a, b] = piece(static_cast<std::size_t>(after - entries_.begin()));
  const double share = (plan_time_s - a.plan_time_s) / (b.plan_time_s - a.plan_time_s);
  return a.at_m + std::clamp(share, 0.0, 1.0) * (b.at_m - a.at_m);
}

/// Mean speed over one second around τ below kRest_mps.
bool ReferenceCurve::waits_at(double plan_time_s) const {
  return (at(plan_time_s + kAround_s) - at(plan_time_s - kAround_s)).norm() <=
         2.0 * kAround_s * kRest_mps;
}

/// Projects the position onto each piece within the window and keeps the nearest projection, at
/// equal distances the one with the smallest lag. A robot close to a waiting reference is in time
/// by definition (see the header).
double ReferenceCurve::lag_s(const Vec2& position_m, double plan_time_s) const {
  SWARM_ASSERT(!empty());
  if ((position_m - at(plan_time_s)).norm() <= kAtRest_m && waits_at(plan_time_s)) return 0.0;
  const double from_s = plan_time_s - kWindow_s;
  const double to_s = plan_time_s + kWindow_s;
  double nearest_m = std::numeric_limits<double>::infinity();
  double lag_s = 0.0;
  const auto later = std::lower_bound(entries_.begin(), entries_.end(), from_s,
                                      [](const Entry& e, double t) { return e.plan_time_s < t; });
  for (auto k = static_cast<std::size_t>(later - entries_.begin()); k < pieces(); ++k) {
    const auto [a, b] = piece(k);
    if (a.plan_time_s > to_s) break;
    const Vec2 path = b.at_m - a.at_m;
    const double length_squared = path.squaredNorm();
    const double duration_s = b.plan_time_s - a.plan_time_s;
    // A piece that goes nowhere is passed at all its times: the one nearest to τ counts.
    double share = length_squared > kSame_m * kSame_m
                       ? std::clamp((position_m - a.at_m).dot(path) / length_squared, 0.0, 1.0)
                       : std::clamp((plan_time_s - a.plan_time_s) / duration_s, 0.0, 1.0);
    share = std::clamp(share, (from_s - a.plan_time_s) / duration_s,
                       (to_s - a.plan_time_s) / duration_s);
    const double distance_m = (position_m - (a.at_m + share * path)).norm();
    const double lag = plan_time_s - (a.plan_time_s + share * duration_s);
    const bool nearer = distance_m < nearest_m - kSame_m;
    if (nearer || (distance_m < nearest_m + kSame_m && std::abs(lag) < std::abs(lag_s))) {
      lag_s = lag;
      nearest_m = std::min(nearest_m, distance_m);
    }
  }
  return lag_s;
}

}  // namespace swarm::monitor
