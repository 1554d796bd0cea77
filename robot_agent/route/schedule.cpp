// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/schedule.hpp"

#include <algorithm>

#include "swarm_core/base/assert.hpp"

namespace swarm::agent {
namespace {

constexpr double kFlat_m = 1e-6;  // per segment: the plan waits

/// The line through (x0, y0) and (x1, y1) at x, clamped to between them; y1 if x0 = x1.
double interpolate(double x, double x0, double x1, double y0, double y1) {
  return x1 > x0 ? y0 + (y1 - y0) * std::clamp((x - x0) / (x1 - x0), 0.0, 1.0) : y1;
}

}  // namespace

/// The mean speed leaves waits out: it converts path before the schedule's begin into time.
Schedule::Schedule(std::vector<Entry> entries) : entries_(std::move(entries)) {
  SWARM_ASSERT(!entries_.empty());
  double moving_s = 0.0;
  for (std::size_t i = 0; i + 1 < entries_.size(); ++i) {
    SWARM_ASSERT(entries_[i].time_s <= entries_[i + 1].time_s);
    SWARM_ASSERT(entries_[i].at_m <= entries_[i + 1].at_m);
    if (entries_[i + 1].at_m - entries_[i].at_m > kFlat_m) {
      moving_s += entries_[i + 1].time_s - entries_[i].time_s;
    }
  }
  const double moved_m = entries_.back().at_m - entries_.front().at_m;
  if (moving_s > 0.0 && moved_m > kFlat_m) mean_speed_mps_ = moved_m / moving_s;
}

/// Linear search from the segment found last, as plan time moves on slowly.
std::size_t Schedule::segment_at(double plan_time_s) const {
  std::size_t i = near_;
  while (i + 2 < entries_.size() && entries_[i + 1].time_s <= plan_time_s) ++i;
  while (i > 0 && entries_[i].time_s > plan_time_s) --i;
  return i;
}

[[gnu::hot]] double Schedule::at_m(double plan_time_s) const {
  if (entries_.size() == 1) return entries_.front().at_m;
  const bool is_near =
      entries_[near_].time_s <= plan_time_s && plan_time_s < entries_[near_ + 1].time_s;
  if (!is_near) near_ = segment_at(plan_time_s);
  const Entry& a = entries_[near_];
  const Entry& b = entries_[near_ + 1];
  return interpolate(plan_time_s, a.time_s, b.time_s, a.at_m, b.at_m);
}

/// τ minus the time at which l* passes the arc length. While l* waits there, any time of the wait
/// has lag 0: a robot that waits with the plan is in time.
double Schedule::lag_s(double plan_time_s, double at_m) const {
  const Entry& first = entries_.front();
  if (at_m < first.at_m) {
    const double missing_s = (first.at_m - at_m) / mean_speed_mps_;
    return std::max(0.0, plan_time_s - first.time_s) + missing_s;
  }
  // l*⁻¹(at_m) = [from, to]: `from` is where l* comes to it, `to` where it goes on from it.
  std::size_t i = 0;
  while (i + 1 < entries_.size() && entries_[i + 1].at_m < at_m - kFlat_m) ++i;
  const auto time_in = [&](std::size_t k) {
    const Entry& a = entries_[k];
    const Entry& b = entries_[std::min(k + 1, entries_.size() - 1)];
    return interpolate(at_m, a.at_m, b.at_m, a.time_s, b.time_s);
  };
  const bool at_start = at_m <= first.at_m + kFlat_m;
  const double from_s = at_start ? first.time_s : time_in(i);
  while (i + 1 < entries_.size() && entries_[i + 1].at_m <= at_m + kFlat_m) ++i;
  const bool at_end = i + 1 == entries_.size();
  if (at_end) return std::min(0.0, plan_time_s - from_s);  // the end: no lag however late
  const double to_s = std::max(from_s, time_in(i));
  if (plan_time_s < from_s) return at_start ? 0.0 : plan_time_s - from_s;
  return std::max(0.0, plan_time_s - to_s);
}

}  // namespace swarm::agent
