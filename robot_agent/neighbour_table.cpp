// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbour_table.hpp"

#include <algorithm>

namespace swarm::agent {
namespace {

constexpr std::size_t kFirstSlots = 128;
constexpr std::size_t kSlotsEach = 4;  // of the index, for every robot known
constexpr std::size_t kSweepAt = 8;    // so many who are gone are worth a new index
constexpr double kStands_mps = 0.01;   // slower is standing: such a robot need not speak

Vec2 nearest_on_segment(const Vec2& point, const Vec2& from, const Vec2& to) {
  const Vec2 along = to - from;
  const double length_squared = along.squaredNorm();
  if (length_squared < 1e-12) return from;
  return from + std::clamp((point - from).dot(along) / length_squared, 0.0, 1.0) * along;
}

}  // namespace

NeighbourTable::NeighbourTable(const NeighbourOptions& options)
    : options_(options), index_(kFirstSlots, kFree) {
  known_.reserve(kFirstSlots / kSlotsEach);
  candidates_.reserve(kFirstSlots / kSlotsEach);
  neighbours_.reserve(kFirstSlots / kSlotsEach);
}

/// The slot of a robot, or the free one where it belongs.
NeighbourTable::Slot& NeighbourTable::slot_of(RobotId robot) {
  const std::size_t mask = index_.size() - 1;
  std::size_t at = (robot.value() * 0x9E37'79B1U >> 16U) & mask;
  while (index_[at] != kFree && known_[index_[at]].robot != robot) at = (at + 1) & mask;
  return index_[at];
}

void NeighbourTable::rebuild_index() {
  if (index_.size() < kSlotsEach * known_.size()) index_.resize(2 * index_.size());
  std::fill(index_.begin(), index_.end(), kFree);
  for (std::size_t i = 0; i < known_.size(); ++i) {
    slot_of(known_[i].robot) = static_cast<Slot>(i);
  }
}

void NeighbourTable::insert(RobotId robot, Slot& slot) {
  slot = static_cast<Slot>(known_.size());
  Known& known = known_.emplace_back();
  known.robot = robot;
  known.radius_m = options_.fleet.of(robot).radius_m;
  if (index_.size() < kSlotsEach * known_.size()) rebuild_index();
}

NeighbourTable::Outcome NeighbourTable::take(const NeighbourReport& report,
                                             const Vec2& own_position_m) {
  Slot& slot = slot_of(report.robot);
  const bool is_known = slot != kFree;
  if (is_known) {
    const Known& known = known_[slot];
    if (report.as_of - known.as_of < options_.forget_after) {
      if (report.sequence == known.sequence) return Outcome::kDuplicate;
      // Sequence numbers wrap: what lies in the half circle behind is older.
      if (static_cast<std::int32_t>(report.sequence - known.sequence) < 0) return Outcome::kStale;
    }
  }
  const double keep_squared = options_.keep_radius_m * options_.keep_radius_m;
  if ((report.position_m - own_position_m).squaredNorm() > keep_squared) {
    if (is_known) known_[slot].gone = true;
    return Outcome::kFar;
  }
  if (!is_known && known_.size() >= kFree) return Outcome::kFar;
  const std::size_t at = is_known ? slot : known_.size();
  if (!is_known) insert(report.robot, slot);
  Known& known = known_[at];
  known.position_m = report.position_m;
  known.velocity_mps = report.velocity_mps;
  known.as_of = report.as_of;
  known.sequence = report.sequence;
  known.late_s = static_cast<float>(report.late_s);
  known.gone = false;
  return Outcome::kTaken;
}

/// Who may be within reach, into candidates_. Most are not, and which ones is a coin toss: no
/// branches. Those that are extrapolated out of the sensing range are gone; a silent one may have
/// stalled within, and is a candidate.
void NeighbourTable::sift(SteadyTime now, const Vec2& own_position_m) {
  const double keep_squared = options_.keep_radius_m * options_.keep_radius_m;
  const double reach_now_m = options_.reach_m;
  const double growth_mps = options_.reach_growth_mps;
  const Duration silence = options_.near_silence;
  const double period_s = to_seconds(silence) / 3.0;
  const Vec2 own_m = own_position_m;
  if (candidates_.size() < known_.size()) candidates_.resize(known_.capacity());
  Known* const known = known_.data();
  std::uint32_t* const candidates = candidates_.data();
  const auto count = static_cast<std::uint32_t>(known_.size());
  std::size_t found = 0;
  std::size_t gone = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    Known& r = known[i];
    const Duration age = now - r.as_of;
    const double age_s = to_seconds(std::max<Duration>(age, Duration::zero()));
    const bool silent = age > silence;
    const Vec2 away_m = r.position_m + age_s * r.velocity_mps - own_m;
    const double away_squared = away_m.squaredNorm();
    const double reach_m = reach_now_m + growth_mps * std::max(0.0, age_s - period_s);
    r.gone |= !silent & (away_squared > keep_squared);
    candidates[found] = i;
    found += static_cast<std::size_t>(silent | (away_squared <= reach_m * reach_m));
    gone += r.gone;
  }
  candidates_found_ = found;
  gone_ = gone;
}

/// What is believed of it, if it is within reach.
void NeighbourTable::believe(Known& r, SteadyTime now, const Vec2& own_position_m) {
  const Duration age = std::max<Duration>(now - r.as_of, Duration::zero());
  const double age_s = to_seconds(age);
  const double period_s = to_seconds(options_.near_silence) / 3.0;
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
  // One that left the sensing range is not silent. Should it come back it will be heard.
  if (age > options_.forget_after ||
      away_squared > options_.keep_radius_m * options_.keep_radius_m) {
    r.gone = true;
    ++gone_;
    return;
  }
  double grown_m = 0.0;
  if (age > options_.expected_silence) {
    grown_m =
        options_.fleet.of(r.robot).speed_max_mps * to_seconds(age - options_.expected_silence);
  }
  const double reach_m =
      options_.reach_m + grown_m + options_.reach_growth_mps * std::max(0.0, stale_s - period_s);
  if (away_squared > reach_m * reach_m) return;
  Neighbour& n = neighbours_.emplace_back();
  n.robot = r.robot;
  n.position_m = position;
  if (!silent) n.velocity_mps = r.velocity_mps;
  n.radius_m = r.radius_m + grown_m;
  n.stale_s = stale_s;
}

std::span<const Neighbour> NeighbourTable::at(SteadyTime now, const Vec2& own_position_m) {
  neighbours_.clear();
  sift(now, own_position_m);
  for (std::size_t i = 0; i < candidates_found_; ++i) {
    Known& known = known_[candidates_[i]];
    if (!known.gone) believe(known, now, own_position_m);
  }
  if (gone_ >= kSweepAt) {
    std::erase_if(known_, [](const Known& known) { return known.gone; });
    rebuild_index();
    gone_ = 0;
  }
  return neighbours_;
}

}  // namespace swarm::agent
