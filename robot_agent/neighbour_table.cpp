// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbour_table.hpp"

#include <algorithm>

namespace swarm::agent {
namespace {

Vec2 nearest_on_segment(const Vec2& point, const Vec2& from, const Vec2& to) {
  const Vec2 along = to - from;
  const double length_squared = along.squaredNorm();
  if (length_squared < 1e-12) return from;
  return from + std::clamp((point - from).dot(along) / length_squared, 0.0, 1.0) * along;
}

}  // namespace

NeighbourTable::NeighbourTable(const NeighbourOptions& options) : options_(options) {
  reports_.reserve(128);
  neighbours_.reserve(128);
}

NeighbourTable::Outcome NeighbourTable::take(const NeighbourReport& report,
                                             const Vec2& own_position_m) {
  const auto at = std::lower_bound(
      reports_.begin(), reports_.end(), report.robot,
      [](const NeighbourReport& known, RobotId robot) { return known.robot < robot; });
  const bool known = at != reports_.end() && at->robot == report.robot;
  if (known && report.as_of - at->as_of < options_.forget_after) {
    if (report.sequence == at->sequence) return Outcome::kDuplicate;
    // Sequence numbers wrap: what lies in the half circle behind is older.
    if (static_cast<std::int32_t>(report.sequence - at->sequence) < 0) return Outcome::kStale;
  }
  if ((report.position_m - own_position_m).norm() > options_.keep_radius_m) {
    if (known) reports_.erase(at);
    return Outcome::kFar;
  }
  if (known) {
    *at = report;
  } else {
    reports_.insert(at, report);
  }
  return Outcome::kTaken;
}

std::span<const Neighbour> NeighbourTable::at(SteadyTime now, const Vec2& own_position_m) {
  std::erase_if(reports_,
                [&](const NeighbourReport& r) { return now - r.as_of > options_.forget_after; });
  neighbours_.clear();
  for (const NeighbourReport& r : reports_) {
    const Duration age = std::max<Duration>(now - r.as_of, Duration::zero());
    const double overdue_s = std::max(0.0, to_seconds(age - options_.expected_silence));
    const Fleet::Body& body = options_.fleet.of(r.robot);
    const double gap_m = (r.position_m - own_position_m).norm() - options_.radius_m - body.radius_m;
    const bool silent = gap_m < options_.near_m && age > options_.near_silence;
    Vec2 position = r.position_m + to_seconds(age) * r.velocity_mps;
    if (silent) {
      const Vec2 stood = r.position_m + to_seconds(options_.near_silence) * r.velocity_mps;
      position = nearest_on_segment(own_position_m, stood, position);
    }
    if ((position - own_position_m).norm() > options_.keep_radius_m) continue;
    neighbours_.push_back({.robot = r.robot,
                           .position_m = position,
                           .velocity_mps = silent ? Vec2::Zero() : r.velocity_mps,
                           .radius_m = body.radius_m + body.speed_max_mps * overdue_s});
  }
  return neighbours_;
}

}  // namespace swarm::agent
