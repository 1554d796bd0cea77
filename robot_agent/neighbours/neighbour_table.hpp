// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/robot/neighbour.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarm_core/base/lanes.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarm_core/base/prefetch.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarmflow/core/time.hpp"
#include "swarm_core/mission/fleet.hpp"

namespace swarm::agent {

/// What another robot said of itself, already checked by the input validation.
struct NeighbourReport {
  RobotId robot;
  std::uint32_t sequence = 0;
  SteadyTime as_of;  ///< when it was true, on our steady clock
  Vec2 position_m = Vec2::Zero();
  Vec2 velocity_mps = Vec2::Zero();
};

/// Those within reach; valid until the thread asks a table again.
struct Neighbourhood {
  std::span<const Neighbour> all;
  std::span<const Neighbour> close;  ///< the first of them: who may touch us or bound our velocity
};

/// How well the words of others reach us, and so, most likely, ours them.
struct LinkQuality {
  bool poor = false;    ///< words are lost, or later than a period and a half
  double late_s = 0.0;  ///< how old they are when they are received, mean
};

struct NeighbourOptions {
  double radius_m = 0.2;       ///< of the robot itself
  Fleet fleet;                 ///< sizes and speeds of the others
  double communication_radius_m = 6.0;  ///< robots farther than this, heard or extrapolated, are not kept
  /// Who is farther than this matters to nobody: not told by at(). Grows with what the knowledge of
  /// a robot is older than a control period. Holds the way of one that may have stalled.
  double reach_m = 6.0;
  double close_m = 6.0;  ///< … and who is farther than this, grown as much, is not close
  double reach_growth_mps = 0.0;
  double near_m = 1.0;          ///< on a degraded link robots this near speak at every tick
  Duration period{};            ///< of control: a body stops two after its last command
  Duration expected_silence{};  ///< a healthy robot speaks at least this often
  Duration forget_after{};
};

/// The robots near us, as far as the bus tells. Between two words of a robot its position is
/// extrapolated; that it may have stalled in between is given beside. From `expected_silence` on its
/// radius grows by its largest speed for every second more, and after `forget_after` it is
/// forgotten. A robot in a crowd hears fifty others at every tick: taking a report is a look into a
/// hash table, and believing one a pass over an array, four robots at a time.
/// The same reports in the same order give the same neighbours in the same order. No allocation
/// once warm.
class NeighbourTable {
 public:
  explicit NeighbourTable(Shared<NeighbourOptions> options);

  enum class Outcome { kTaken, kDuplicate, kStale, kFar };

  /// Takes a report that was `late` when it was received. Older or repeated sequence numbers are
  /// refused; a robot that was silent for `forget_after` may start over (it was restarted).
  Outcome take(const NeighbourReport& report, const Vec2& own_position_m, Duration late = {});

  /// Neighbours within reach as of `now`.
  Neighbourhood at(SteadyTime now, const Vec2& own_position_m);

  /// Brings what take() and at() will look at into the cache: for whoever ticks many robots in
  /// turn, while it ticks the one before.
  void prefetch() const {
    swarm::prefetch(blocks_.data(), blocks_.size() * sizeof(LaneBlock));
    swarm::prefetch(index_.data(), index_.size() * sizeof(Slot));
  }

  const LinkQuality& link() const { return link_; }

  /// Robots known at the last at(), within reach or not.
  std::size_t known() const { return count_ - gone_; }

 private:
  /// The last state updates of four robots, in two cache lines, counted from then_ and here_m_ so that
  /// floats hold them to micrometres.
  struct alignas(64) LaneBlock {
    Float4 x_m, y_m;
    Float4 vx_mps, vy_mps;
    Int4 as_of_us;  // kGone: nobody
    Int4 late_us;
    std::array<RobotId, kLanes> robot;
    std::array<std::uint32_t, kLanes> sequence;
  };
  static constexpr std::int32_t kGone = -(1 << 30);
  /// Number of a robot in fours_. Small, so that three of four slots can be free and still few
  /// lines are used.
  using Slot = std::uint16_t;
  static constexpr Slot kFree = 0xFFFF;

  Slot& slot_of(RobotId robot);
  void insert(RobotId robot, Slot& slot);
  void count_lost(const LaneBlock& block, std::size_t lane, const NeighbourReport& report,
                  std::int32_t as_of_us, const Vec2& own_position_m);
  void update_link_quality();
  void rebuild_index();
  std::int32_t since_then_us(SteadyTime t) const;
  void keep_frame(SteadyTime now, const Vec2& own_position_m);
  struct FilterPass;
  void filter(std::int32_t now_us, const Vec2& own_position_m, FilterPass& pass);
  void estimate(std::size_t known, const Vec2& own_position_m, const FilterPass& pass,
               Neighbour& n) const;
  void sweep();

  Shared<NeighbourOptions> options_;
  double period_s_;
  double silence_s_;  // that is expected
  std::int32_t period_us_;
  std::int32_t silence_us_;
  std::int32_t forget_after_us_;
  SteadyTime then_;
  Vec2 here_m_ = Vec2::Zero();
  std::vector<LaneBlock> blocks_;
  std::size_t count_ = 0;    // of robots in fours_, gone or not
  std::size_t gone_ = 0;     // of those, as of the last at()
  std::vector<Slot> index_;  // hash table with open addressing, a power of two of them
  /// Words since the last at().
  struct Tally {
    std::uint32_t updates = 0;
    std::uint32_t came = 0;  // without a gap before, or with both its ends in range
    std::uint32_t lost = 0;
    std::int64_t late_us = 0;
  };
  Tally tally_;
  LinkQuality link_;
  double loss_ = 0.0;  // share of words lost, mean of the last ones
};

}  // namespace swarm::agent
