// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbour_table.hpp"

#include <algorithm>

namespace swarm::agent {
namespace {

constexpr std::size_t kFirstSlots = 64;
constexpr double kStands_mps = 0.01;  // slower is standing: such a robot need not speak

Vec2 nearest_on_segment(const Vec2& point, const Vec2& from, const Vec2& to) {
  const Vec2 along = to - from;
  const double length_squared = along.squaredNorm();
  if (length_squared < 1e-12) return from;
  return from + std::clamp((point - from).dot(along) / length_squared, 0.0, 1.0) * along;
}

}  // namespace

NeighbourTable::NeighbourTable(const NeighbourOptions& options)
    : options_(options), index_(kFirstSlots) {
  known_.reserve(kFirstSlots / 2);
  neighbours_.reserve(kFirstSlots / 2);
}

/// The slot of a robot, or the free one where it belongs.
NeighbourTable::Slot& NeighbourTable::slot_of(RobotId robot) {
  const std::size_t mask = index_.size() - 1;
  std::size_t at = (robot.value() * 0x9E37'79B1U >> 16U) & mask;
  while (index_[at].known != kFree && index_[at].robot != robot) at = (at + 1) & mask;
  return index_[at];
}

void NeighbourTable::rebuild_index() {
  if (index_.size() < 2 * known_.size()) index_.resize(2 * index_.size());
  std::fill(index_.begin(), index_.end(), Slot{});
  for (std::uint32_t i = 0; i < known_.size(); ++i) {
    slot_of(known_[i].robot) = {known_[i].robot, i};
  }
}

void NeighbourTable::insert(const NeighbourReport& report, Slot& slot) {
  slot = {report.robot, static_cast<std::uint32_t>(known_.size())};
  Known& known = known_.emplace_back();
  known.robot = report.robot;
  known.radius_m = options_.fleet.of(report.robot).radius_m;
  if (index_.size() < 2 * known_.size()) rebuild_index();
}

NeighbourTable::Outcome NeighbourTable::take(const NeighbourReport& report,
                                             const Vec2& own_position_m) {
  Slot& slot = slot_of(report.robot);
  const bool is_known = slot.known != kFree;
  if (is_known) {
    const Known& known = known_[slot.known];
    if (report.as_of - known.as_of < options_.forget_after) {
      if (report.sequence == known.sequence) return Outcome::kDuplicate;
      // Sequence numbers wrap: what lies in the half circle behind is older.
      if (static_cast<std::int32_t>(report.sequence - known.sequence) < 0) return Outcome::kStale;
    }
  }
  const double keep_squared = options_.keep_radius_m * options_.keep_radius_m;
  if ((report.position_m - own_position_m).squaredNorm() > keep_squared) {
    if (is_known) any_gone_ = known_[slot.known].gone = true;
    return Outcome::kFar;
  }
  const std::size_t at = is_known ? slot.known : known_.size();
  if (!is_known) insert(report, slot);
  Known& known = known_[at];
  known.position_m = report.position_m;
  known.velocity_mps = report.velocity_mps;
  known.as_of = report.as_of;
  known.sequence = report.sequence;
  known.late_s = static_cast<float>(report.late_s);
  known.gone = false;
  return Outcome::kTaken;
}

std::span<const Neighbour> NeighbourTable::at(SteadyTime now, const Vec2& own_position_m) {
  neighbours_.clear();
  const double period_s = to_seconds(options_.near_silence) / 3.0;
  const double keep_squared = options_.keep_radius_m * options_.keep_radius_m;
  for (Known& r : known_) {
    const Duration age = std::max<Duration>(now - r.as_of, Duration::zero());
    if (age > options_.forget_after) any_gone_ = r.gone = true;
    if (r.gone) continue;
    const double age_s = to_seconds(age);
    const double speaks_within_m = options_.near_m + options_.radius_m + r.radius_m;
    const bool near =
        (r.position_m - own_position_m).squaredNorm() < speaks_within_m * speaks_within_m;
    const bool silent = near && age > options_.near_silence;
    Vec2 position = r.position_m + age_s * r.velocity_mps;
    if (silent) {
      const Vec2 stood = r.position_m + to_seconds(options_.near_silence) * r.velocity_mps;
      position = nearest_on_segment(own_position_m, stood, position);
    }
    const bool must_speak = near && r.velocity_mps.squaredNorm() > kStands_mps * kStands_mps;
    const double stale_s =
        must_speak ? age_s : std::min(age_s, static_cast<double>(r.late_s) + period_s);
    const double away_squared = (position - own_position_m).squaredNorm();
    // It is not silent but out of range. Should it come back it will be heard.
    if (away_squared > keep_squared) {
      any_gone_ = r.gone = true;
      continue;
    }
    const double reach_m = options_.reach_m + options_.reach_growth_mps * stale_s;
    if (away_squared > reach_m * reach_m) continue;
    Neighbour& n = neighbours_.emplace_back();
    n.robot = r.robot;
    n.position_m = position;
    if (!silent) n.velocity_mps = r.velocity_mps;
    n.radius_m = r.radius_m;
    if (age > options_.expected_silence) {
      n.radius_m +=
          options_.fleet.of(r.robot).speed_max_mps * to_seconds(age - options_.expected_silence);
    }
    n.stale_s = stale_s;
  }
  if (any_gone_) {
    std::erase_if(known_, [](const Known& known) { return known.gone; });
    rebuild_index();
    any_gone_ = false;
  }
  return neighbours_;
}

}  // namespace swarm::agent
