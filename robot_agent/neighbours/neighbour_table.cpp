// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbours/neighbour_table.hpp"

#include <algorithm>
#include <utility>

#include "robot_agent/neighbours/silent_neighbours.hpp"

namespace swarm::agent {
namespace {

constexpr std::size_t kFirstSlots = 128;
constexpr std::size_t kSlotsEach = 4;  // of the index, for every robot known
constexpr std::size_t kSweepAt = 8;    // lanes of gone robots that are worth a compaction
constexpr double kStopped_mps = 0.01;  // slower counts as stopped: such a robot may be silent
constexpr double kUpdates = 64.0;      // averaging window of the link quality, in messages
constexpr double kPoor = 0.02;         // loss rate above which the link is degraded: 2 of 64 lost
constexpr double kClean = 0.005;       // loss rate below which it is good again (hysteresis)
constexpr double kInside = 0.8;        // of the communication radius: beyond, gaps are no losses
constexpr std::int32_t kLongest_us = 1 << 29;  // clamp of ages, 537 s: differences fit 32 bits
constexpr Duration kFrameFor = std::chrono::seconds(60);
constexpr double kFrame_m = 100.0;

std::int32_t to_us(Duration d) {
  constexpr std::int64_t kMost = kLongest_us;
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(d / std::chrono::microseconds(1), -kMost, kMost));
}

constexpr double in_s(std::int64_t us) { return 1e-6 * static_cast<double>(us); }

}  // namespace

/// The intermediate results of one call of at(). No state is kept from call to call, so that all
/// robots that a thread ticks in turn share one buffer, which stays in the cache.
struct NeighbourTable::FilterPass {
  void make_room(std::size_t count);  // for this number of blocks

  /// The extrapolated positions of four robots.
  struct LaneBlock {
    Float4 x_m, y_m;  // dead-reckoned
    Int4 age_us;
  };
  std::vector<LaneBlock> blocks;     // as the table's
  std::vector<std::uint32_t> close;  // numbers of the close robots; close_found are valid
  std::vector<std::uint32_t> far;    // numbers of the others within reach; far_found are valid
  std::size_t close_found = 0;
  std::size_t far_found = 0;
  std::vector<Neighbour> neighbours;
  SilentNeighbours silent;
};

NeighbourTable::NeighbourTable(Shared<NeighbourOptions> options)
    : options_(std::move(options)),
      period_s_(to_seconds(options_->period)),
      silence_s_(to_seconds(options_->expected_silence)),
      period_us_(to_us(options_->period)),
      silence_us_(to_us(options_->expected_silence)),
      forget_after_us_(to_us(options_->forget_after)),
      index_(kFirstSlots, kFree) {
  blocks_.reserve(kFirstSlots / kSlotsEach / kLanes);
}

/// The slot of a robot, or the free one where it belongs: Fibonacci hashing and linear probing. At
/// least three of four slots are free, so that a probe rarely takes a second step.
[[gnu::hot]] NeighbourTable::Slot& NeighbourTable::slot_of(RobotId robot) {
  const std::size_t mask = index_.size() - 1;
  std::size_t at = (robot.value() * 0x9E37'79B1U >> 16U) & mask;
  while (index_[at] != kFree && blocks_[index_[at] / kLanes].robot[index_[at] % kLanes] != robot) {
    at = (at + 1) & mask;
  }
  return index_[at];
}

/// Doubles the index when less than three quarters of it are free, and enters all robots again.
void NeighbourTable::rebuild_index() {
  if (index_.size() < kSlotsEach * count_) index_.resize(2 * index_.size());
  std::fill(index_.begin(), index_.end(), kFree);
  for (std::size_t i = 0; i < count_; ++i) {
    slot_of(blocks_[i / kLanes].robot[i % kLanes]) = static_cast<Slot>(i);
  }
}

/// Appends a robot as the last lane, and opens a block of gone lanes when the last one is full. The
/// slot reference is invalid afterwards: the index may be rebuilt.
void NeighbourTable::insert(RobotId robot, Slot& slot) {
  slot = static_cast<Slot>(count_);
  if (count_ % kLanes == 0) blocks_.emplace_back().as_of_us = all(kGone);
  blocks_.back().robot[count_ % kLanes] = robot;
  ++count_;
  if (index_.size() < kSlotsEach * count_) rebuild_index();
}

/// A time as microseconds from the origin then_, clamped to ±kLongest_us.
std::int32_t NeighbourTable::since_then_us(SteadyTime t) const { return to_us(t - then_); }

/// Moves the origin of time and space to `now` and our position once it is 60 s or 100 m away:
/// floats resolve 8 µm at 100 m, and ages stay within kLongest_us.
[[gnu::hot]] void NeighbourTable::keep_frame(SteadyTime now, const Vec2& own_position_m) {
  const Vec2 by_m = own_position_m - here_m_;
  if (now - then_ <= kFrameFor && by_m.squaredNorm() <= kFrame_m * kFrame_m) return;
  const std::int32_t by_us = to_us(now - then_);
  for (LaneBlock& block : blocks_) {
    block.x_m -= static_cast<float>(by_m.x());
    block.y_m -= static_cast<float>(by_m.y());
    block.as_of_us = block.as_of_us == all(kGone) ? all(kGone) : block.as_of_us - by_us;
  }
  then_ = now;
  here_m_ = own_position_m;
}

/// Adds a report to the tally of the loss rate. Skipped sequence numbers count as lost messages
/// only where the report before the gap came from well inside the communication radius and is not
/// older than the expected silence: otherwise the sender may have been out of range meanwhile. At
/// most four losses count for one gap.
void NeighbourTable::count_lost(const LaneBlock& block, std::size_t lane,
                                const NeighbourReport& report, std::int32_t as_of_us,
                                const Vec2& own_position_m) {
  const std::uint32_t lost = report.sequence - block.sequence[lane] - 1U;
  if (lost > 0) {
    const double inside_m = kInside * options_->communication_radius_m;
    const Vec2 before_m = here_m_ + Vec2(block.x_m[lane], block.y_m[lane]);
    if (as_of_us - block.as_of_us[lane] > silence_us_ ||
        (before_m - own_position_m).squaredNorm() > inside_m * inside_m) {
      return;
    }
  }
  ++tally_.came;
  tally_.lost += std::min(lost, 4U);
}

/// Updates the moving averages of loss rate and latency with the messages since the last at(): n of
/// them weigh n/(64 + n). The link is degraded above kPoor until the loss rate is below kClean, or
/// while the mean latency exceeds 1.5 control periods.
[[gnu::hot]] void NeighbourTable::update_link_quality() {
  if (tally_.updates == 0) return;
  const auto share_of_all = [](std::uint32_t count) { return count / (kUpdates + count); };
  const double late_s = in_s(tally_.late_us) / tally_.updates;
  link_.late_s += share_of_all(tally_.updates) * (late_s - link_.late_s);
  if (const std::uint32_t expected = tally_.came + tally_.lost; expected > 0) {
    const double lost = static_cast<double>(tally_.lost) / expected;
    loss_ += share_of_all(expected) * (lost - loss_);
  }
  link_.poor = loss_ > (link_.poor ? kClean : kPoor) || link_.late_s > 1.5 * period_s_;
  tally_ = {};
}

/// Amortised O(1). A robot unknown so far, or silent for longer than expected, is taken with any
/// sequence number: its process may have been restarted and counts from the beginning.
[[gnu::hot]] NeighbourTable::Outcome NeighbourTable::take(const NeighbourReport& report,
                                                          const Vec2& own_position_m,
                                                          Duration late) {
  keep_frame(report.as_of, own_position_m);
  Slot& slot = slot_of(report.robot);
  const bool is_known = slot != kFree;
  const std::int32_t as_of_us = since_then_us(report.as_of);
  if (is_known) {
    const LaneBlock& block = blocks_[slot / kLanes];
    const std::size_t lane = slot % kLanes;
    const std::int32_t since_us = as_of_us - block.as_of_us[lane];
    if (since_us < forget_after_us_) {
      if (report.sequence == block.sequence[lane]) return Outcome::kDuplicate;
      // Sequence numbers wrap: what lies in the half circle behind is older.
      const bool is_older = static_cast<std::int32_t>(report.sequence - block.sequence[lane]) < 0;
      if (is_older && since_us < silence_us_) return Outcome::kStale;
      if (!is_older) count_lost(block, lane, report, as_of_us, own_position_m);
    }
  }
  // A known robot that reports from outside of the communication radius is not kept any longer.
  const double keep_squared = options_->communication_radius_m * options_->communication_radius_m;
  if ((report.position_m - own_position_m).squaredNorm() > keep_squared) {
    if (is_known) blocks_[slot / kLanes].as_of_us[slot % kLanes] = kGone;
    return Outcome::kFar;
  }
  if (!is_known && count_ >= kFree) return Outcome::kFar;
  const std::size_t known = is_known ? slot : count_;
  if (!is_known) insert(report.robot, slot);
  LaneBlock& block = blocks_[known / kLanes];
  const std::size_t lane = known % kLanes;
  // Positions are stored relative to here_m_, where floats are precise.
  block.x_m[lane] = static_cast<float>(report.position_m.x() - here_m_.x());
  block.y_m[lane] = static_cast<float>(report.position_m.y() - here_m_.y());
  block.vx_mps[lane] = static_cast<float>(report.velocity_mps.x());
  block.vy_mps[lane] = static_cast<float>(report.velocity_mps.y());
  block.as_of_us[lane] = as_of_us;
  block.late_us[lane] = std::max(to_us(late), 0);
  tally_.late_us += block.late_us[lane];
  ++tally_.updates;
  block.sequence[lane] = report.sequence;
  return Outcome::kTaken;
}

/// Room for all lanes in each list: numbers are written before it is known whether they count.
void NeighbourTable::FilterPass::make_room(std::size_t count) {
  blocks.resize(count);
  close.resize(kLanes * count);
  far.resize(kLanes * count);
  neighbours.resize(kLanes * count);
}

/// The filter pass: extrapolates all known robots, four at a time, and sorts the numbers of those
/// within reach into close and far ones. O(known robots). Which robots are within reach is
/// unpredictable, so the pass has no branch on it. Robots that were extrapolated out of the
/// communication radius, or are older than forget_after, are marked as gone; one that comes back is
/// received again. All quantities are floats relative to here_m_ and then_. On a good link a silent
/// robot is where dead reckoning has it (see SendPolicy), so that its information is only as old as
/// messages are late; on a degraded one it is as old as the state.
[[gnu::hot]] void NeighbourTable::filter(std::int32_t now_us, const Vec2& own_position_m,
                                         FilterPass& pass) {
  // reach_now_m: the reach for information of age 0.
  const auto keep_m = static_cast<float>(options_->communication_radius_m);
  const auto growth_mps = static_cast<float>(options_->reach_growth_mps);
  const auto period_s = static_cast<float>(period_s_);
  const float reach_now_m = static_cast<float>(options_->reach_m) - growth_mps * period_s;
  const auto beyond_close_m = static_cast<float>(options_->reach_m - options_->close_m);
  const auto own_x_m = static_cast<float>(own_position_m.x() - here_m_.x());
  const auto own_y_m = static_cast<float>(own_position_m.y() - here_m_.y());
  const Int4 late_us =
      all(link_.poor ? kLongest_us : static_cast<std::int32_t>(1e6 * link_.late_s));
  // In registers: the compiler has to read members again after every store.
  const std::size_t blocks = blocks_.size();
  if (pass.blocks.size() < blocks) pass.make_room(2 * blocks);
  LaneBlock* const known = blocks_.data();
  FilterPass::LaneBlock* const extrapolated = pass.blocks.data();
  const Int4 forget_after_us = all(forget_after_us_);
  const Int4 healthy_us = all(silence_us_ - period_us_);
  std::uint32_t* next_close = pass.close.data();
  std::uint32_t* next_far = pass.far.data();
  Int4 gone = all(0);
  for (std::uint32_t i = 0; i < blocks; ++i) {
    LaneBlock& f = known[i];
    // Dead reckoning at constant velocity.
    const Int4 age_us = max(now_us - f.as_of_us, all(0));
    const Float4 age_s = 1e-6F * to_float(age_us);
    const Float4 x_m = f.x_m + age_s * f.vx_mps;
    const Float4 y_m = f.y_m + age_s * f.vy_mps;
    const Float4 away_x_m = x_m - own_x_m;
    const Float4 away_y_m = y_m - own_y_m;
    const Float4 away_squared = away_x_m * away_x_m + away_y_m * away_y_m;
    // A state that arrived late keeps its lateness. Beyond the expected silence less one period the
    // age grows with time on any link: the robot should have published.
    const Int4 known_us = min(age_us, max(f.late_us, late_us));
    const Int4 information_age_us = max(known_us, age_us - healthy_us);
    const Float4 information_age_s = max(1e-6F * to_float(information_age_us), all(period_s));
    const Float4 reach_m = reach_now_m + growth_mps * information_age_s;
    // Masks are −1 (all bits) where true, so that subtracting one counts.
    const Int4 is_gone = (away_squared > keep_m * keep_m) | (age_us > forget_after_us);
    const Int4 in_reach = ~is_gone & (away_squared <= reach_m * reach_m);
    const Float4 close_m = reach_m - beyond_close_m;
    const Int4 is_close = in_reach & (away_squared <= close_m * close_m);
    const Int4 is_far = in_reach & ~is_close;
    gone -= is_gone;
    // Stores only where a robot has just gone: written cache lines are costly.
    if (bits_of(is_gone & (f.as_of_us != all(kGone))) != 0) {
      f.as_of_us = is_gone ? all(kGone) : f.as_of_us;
    }
    extrapolated[i] = {x_m, y_m, age_us};
    next_close = write_set(bits_of(is_close), kLanes * i, next_close);
    next_far = write_set(bits_of(is_far), kLanes * i, next_far);
  }
  pass.close_found = static_cast<std::size_t>(next_close - pass.close.data());
  pass.far_found = static_cast<std::size_t>(next_far - pass.far.data());
  // The empty lanes behind the last robot are marked as gone, but are no robots.
  gone_ =
      static_cast<std::size_t>(gone[0] + gone[1] + gone[2] + gone[3]) - (kLanes * blocks - count_);
}

/// The estimate of one robot within reach: extrapolated position, radius, age of the information
/// and the time for which the robot may have been stopped.
[[gnu::hot]] void NeighbourTable::estimate(std::size_t known, const Vec2& own_position_m,
                                           const FilterPass& pass, Neighbour& n) const {
  const LaneBlock& block = blocks_[known / kLanes];
  const FilterPass::LaneBlock& filtered = pass.blocks[known / kLanes];
  const std::size_t lane = known % kLanes;
  const double age_s = in_s(filtered.age_us[lane]);
  const double radius_m = options_->fleet.of(block.robot[lane]).radius_m;
  n.robot = block.robot[lane];
  n.position_m = here_m_ + Vec2(filtered.x_m[lane], filtered.y_m[lane]);
  n.velocity_mps = {block.vx_mps[lane], block.vy_mps[lane]};
  n.radius_m = radius_m;
  // A robot silent for longer than expected may be anywhere it can have driven to since.
  if (filtered.age_us[lane] > silence_us_) {
    n.radius_m += options_->fleet.of(n.robot).speed_max_mps * (age_s - silence_s_);
  }
  n.information_age_s = std::min(age_s, std::max(in_s(block.late_us[lane]), link_.late_s));
  // On a degraded link robots this near publish at every tick (see SendPolicy): if none has
  // arrived, the information is as old as the last state, not only as late as messages are.
  const double stopped_mps = options_->scale * kStopped_mps;
  if (link_.poor && n.velocity_mps.squaredNorm() > stopped_mps * stopped_mps) {
    const double updates_within_m = options_->near_m + options_->radius_m + radius_m;
    const Vec2 sent_at_m = here_m_ + Vec2(block.x_m[lane], block.y_m[lane]);
    if ((sent_at_m - own_position_m).squaredNorm() < updates_within_m * updates_within_m) {
      n.information_age_s = age_s;
    }
  }
  // A body stops two periods after its last command, and its process may have died right after this
  // state.
  n.possible_stop_age_s = in_s(std::max(0, filtered.age_us[lane] - 2 * period_us_));
  n.is_silent = false;
}

/// Whether the disc of a silent robot replaces what the filter pass has extrapolated.
bool NeighbourTable::is_silent(std::size_t known, const FilterPass& pass,
                               const SilentRobots& silent) const {
  const std::size_t lane = known % kLanes;
  return pass.blocks[known / kLanes].age_us[lane] > silence_us_ &&
         silent.covers(blocks_[known / kLanes].robot[lane]);
}

/// Removes the lanes of gone robots, in order, and builds the index again. O(known robots).
void NeighbourTable::sweep() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const LaneBlock& from = blocks_[i / kLanes];
    const std::size_t f = i % kLanes;
    if (from.as_of_us[f] == kGone) continue;
    LaneBlock& to = blocks_[kept / kLanes];
    const std::size_t t = kept % kLanes;
    to.x_m[t] = from.x_m[f];
    to.y_m[t] = from.y_m[f];
    to.vx_mps[t] = from.vx_mps[f];
    to.vy_mps[t] = from.vy_mps[f];
    to.as_of_us[t] = from.as_of_us[f];
    to.late_us[t] = from.late_us[f];
    to.robot[t] = from.robot[f];
    to.sequence[t] = from.sequence[f];
    ++kept;
  }
  for (std::size_t i = kept; i < count_; ++i) blocks_[i / kLanes].as_of_us[i % kLanes] = kGone;
  count_ = kept;
  blocks_.resize((count_ + kLanes - 1) / kLanes);
  gone_ = 0;
  rebuild_index();
}

/// Order of results: close robots first, both groups in the order in which robots became known and
/// then the silent ones, so that equal reports give equal neighbours.
[[gnu::hot]] Neighbourhood NeighbourTable::at(SteadyTime now, const Vec2& own_position_m,
                                              const SilentRobots* silent) {
  update_link_quality();
  keep_frame(now, own_position_m);
  static thread_local FilterPass pass;
  filter(since_then_us(now), own_position_m, pass);
  SilentNeighbours& of_silent = pass.silent;
  of_silent.clear();
  if (silent != nullptr) {
    find_silent_neighbours(*silent, *options_, own_position_m, of_silent);
  }
  const std::size_t room =
      pass.close_found + pass.far_found + of_silent.close.size() + of_silent.far.size();
  if (pass.neighbours.size() < room) pass.neighbours.resize(2 * room);
  const auto append = [&](std::span<const std::uint32_t> found, const std::vector<Neighbour>& discs,
                          Neighbour* to) {
    for (const std::uint32_t known : found) {
      if (silent != nullptr && is_silent(known, pass, *silent)) continue;
      estimate(known, own_position_m, pass, *to++);
    }
    return std::copy(discs.begin(), discs.end(), to);
  };
  Neighbour* const begin = pass.neighbours.data();
  Neighbour* const end_of_close =
      append(std::span(pass.close).first(pass.close_found), of_silent.close, begin);
  Neighbour* const end =
      append(std::span(pass.far).first(pass.far_found), of_silent.far, end_of_close);
  // Last: sweeping renumbers the robots that the filter pass has listed.
  if (gone_ >= kSweepAt) sweep();
  return {
      .all = {begin, end}, .close = {begin, end_of_close}, .is_within_silent = of_silent.is_within};
}

}  // namespace swarm::agent
