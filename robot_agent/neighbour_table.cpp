// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbour_table.hpp"

#include <algorithm>
#include <limits>

namespace swarm::agent {
namespace {

constexpr std::size_t kFirstSlots = 128;
constexpr std::size_t kSlotsEach = 4;  // of the index, for every robot known
constexpr std::size_t kSweepAt = 8;    // so many who are gone are worth a new index
constexpr double kStands_mps = 0.01;   // slower is standing: such a robot need not speak
constexpr double kOfWords = 1.0 / 64;  // weight of a word in what is thought of the link
constexpr double kPoor = 0.02;         // of two words in the last sixty-four, …
constexpr double kClean = 0.005;       // … until eighty in a row came
constexpr double kInside = 0.8;        // of the range: who is farther may have been out of it

/// A product: to_seconds() divides, which is a tenth of what believing a robot costs.
double age_in_s(SteadyTime now, SteadyTime as_of) {
  constexpr double kSecond = std::chrono::duration<double>(Duration(1)).count();
  return std::max(0.0, kSecond * static_cast<double>((now - as_of).count()));
}

}  // namespace

NeighbourTable::NeighbourTable(const NeighbourOptions& options)
    : options_(options),
      period_s_(to_seconds(options.period)),
      silence_s_(to_seconds(options.expected_silence)),
      forget_after_s_(to_seconds(options.forget_after)),
      index_(kFirstSlots, kFree) {
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

/// Numbers that were left out are words that were lost, where both ends of the gap were in range.
void NeighbourTable::judge_link(const Known& before, const NeighbourReport& report,
                                const Vec2& own_position_m) {
  link_.late_s += kOfWords * (report.late_s - link_.late_s);
  const double inside_m = kInside * options_.keep_radius_m;
  if (report.as_of - before.as_of > options_.expected_silence ||
      (before.position_m - own_position_m).squaredNorm() > inside_m * inside_m) {
    return;
  }
  const double lost = std::min(report.sequence - before.sequence - 1U, 4U);
  loss_ += kOfWords * (lost - (lost + 1.0) * loss_);
  link_.poor = loss_ > (link_.poor ? kClean : kPoor) || link_.late_s > 1.5 * period_s_;
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
      judge_link(known, report, own_position_m);
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
/// branches. Those that are extrapolated out of the sensing range are gone: should they come back
/// they will be heard.
void NeighbourTable::sift(SteadyTime now, const Vec2& own_position_m) {
  const double keep_squared = options_.keep_radius_m * options_.keep_radius_m;
  const double growth_mps = options_.reach_growth_mps;
  const double period_s = period_s_;
  const double reach_now_m = options_.reach_m - growth_mps * period_s;
  const Vec2 own_m = own_position_m;
  // What is too old is as old as it is, anything else at most as late as words are.
  const double late_s = link_.poor ? std::numeric_limits<double>::infinity() : link_.late_s;
  const double silence_s = silence_s_ - period_s_;
  if (candidates_.size() < known_.size()) candidates_.resize(known_.capacity());
  Known* const known = known_.data();
  std::uint32_t* const candidates = candidates_.data();
  const auto count = static_cast<std::uint32_t>(known_.size());
  std::size_t found = 0;
  std::size_t gone = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    Known& r = known[i];
    const double age_s = age_in_s(now, r.as_of);
    const Vec2 away_m = r.position_m + age_s * r.velocity_mps - own_m;
    const double away_squared = away_m.squaredNorm();
    const double known_s = std::min(age_s, std::max<double>(r.late_s, late_s));
    const double stale_s = std::max(known_s, age_s - silence_s);
    const double reach_m = reach_now_m + growth_mps * std::max(stale_s, period_s);
    r.gone |= away_squared > keep_squared;
    candidates[found] = i;
    found += static_cast<std::size_t>(away_squared <= reach_m * reach_m);
    gone += r.gone;
  }
  candidates_found_ = found;
  gone_ = gone;
}

/// What is believed of it, if it is within reach.
void NeighbourTable::believe(Known& r, SteadyTime now, const Vec2& own_position_m) {
  const double age_s = age_in_s(now, r.as_of);
  if (age_s > forget_after_s_) {
    r.gone = true;
    ++gone_;
    return;
  }
  double stale_s = std::min(age_s, std::max<double>(r.late_s, link_.late_s));
  if (link_.poor && r.velocity_mps.squaredNorm() > kStands_mps * kStands_mps) {
    const double speaks_within_m = options_.near_m + options_.radius_m + r.radius_m;
    const double spoke_at_squared = (r.position_m - own_position_m).squaredNorm();
    if (spoke_at_squared < speaks_within_m * speaks_within_m) stale_s = age_s;
  }
  double grown_m = 0.0;
  if (age_s > silence_s_) {
    grown_m = options_.fleet.of(r.robot).speed_max_mps * (age_s - silence_s_);
  }
  const double stalled_s = std::max(0.0, age_s - 2.0 * period_s_);
  const double reach_m =
      options_.reach_m + grown_m + options_.reach_growth_mps * std::max(0.0, stale_s - period_s_);
  const Vec2 position = r.position_m + age_s * r.velocity_mps;
  if ((position - own_position_m).squaredNorm() > reach_m * reach_m) return;
  neighbours_.push_back({.robot = r.robot,
                         .position_m = position,
                         .velocity_mps = r.velocity_mps,
                         .radius_m = r.radius_m + grown_m,
                         .stale_s = stale_s,
                         .stalled_s = stalled_s});
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
