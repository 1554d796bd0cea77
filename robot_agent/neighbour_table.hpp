// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarm_core/base/ids.hpp"
#include "swarm_core/base/linalg.hpp"
#include "swarm_core/base/prefetch.hpp"
#include "swarm_core/base/time.hpp"
#include "swarm_core/mission/fleet.hpp"

namespace swarm::agent {

/// What another robot said of itself, already checked at the edge.
struct NeighbourReport {
  RobotId robot;
  std::uint32_t sequence = 0;
  SteadyTime as_of;  ///< when it was true, on our steady clock
  Vec2 position_m = Vec2::Zero();
  Vec2 velocity_mps = Vec2::Zero();
  double late_s = 0.0;  ///< how old it was when it was heard
};

/// What we believe of a neighbour now.
struct Neighbour {
  RobotId robot;
  Vec2 position_m = Vec2::Zero();  ///< dead-reckoned
  Vec2 velocity_mps = Vec2::Zero();
  double radius_m = 0.0;  ///< its radius, grown while it is silent for longer than it should be
  /// How old our knowledge of its motion is: the time a word takes, since it would have spoken had
  /// it turned; on a poor link, of one that moves near us, the time since its last.
  double stale_s = 0.0;
  /// For how long it may have stood by now, had its process stalled after its last word.
  double stalled_s = 0.0;
};

/// How well the words of others reach us, and so, most likely, ours them.
struct LinkQuality {
  bool poor = false;    ///< words are lost, or later than a period and a half
  double late_s = 0.0;  ///< how old they are when they are heard, mean
};

struct NeighbourOptions {
  double radius_m = 0.2;       ///< of the robot itself
  Fleet fleet;                 ///< sizes and speeds of the others
  double keep_radius_m = 6.0;  ///< robots farther than this, heard or extrapolated, are not kept
  /// Who is farther than this matters to nobody: not told by at(). Grows with what the knowledge of
  /// a robot is older than a control period. Holds the way of one that may have stalled.
  double reach_m = 6.0;
  double reach_growth_mps = 0.0;
  double near_m = 1.0;          ///< on a poor link robots this near speak at every tick
  Duration period{};            ///< of control: a body stops two after its last command
  Duration expected_silence{};  ///< a healthy robot speaks at least this often
  Duration forget_after{};
};

/// The robots near us, as far as the bus tells. Between two words of a robot its position is
/// extrapolated; that it may have stalled in between is told beside. From `expected_silence` on its
/// radius grows by its largest speed for every second more, and after `forget_after` it is
/// forgotten. A robot in a crowd hears fifty others at every tick: taking a report is a look into a
/// hash table, and believing one a pass over an array.
/// The same reports in the same order give the same neighbours in the same order. No allocation
/// once warm.
class NeighbourTable {
 public:
  explicit NeighbourTable(const NeighbourOptions& options);

  enum class Outcome { kTaken, kDuplicate, kStale, kFar };

  /// Takes a report. Older or repeated sequence numbers are refused; a robot that was silent for
  /// `forget_after` may start over (it was restarted).
  Outcome take(const NeighbourReport& report, const Vec2& own_position_m);

  /// Neighbours within reach as of `now`; valid until the next call.
  std::span<const Neighbour> at(SteadyTime now, const Vec2& own_position_m);

  /// Brings what take() and at() will look at into the cache: for whoever ticks many robots in
  /// turn, while it ticks the one before.
  void prefetch() const {
    swarm::prefetch(known_.data(), known_.size() * sizeof(Known));
    swarm::prefetch(index_.data(), index_.size() * sizeof(Slot));
  }

  const LinkQuality& link() const { return link_; }

  /// Robots known at the last at(), within reach or not.
  std::size_t known() const { return known_.size() - gone_; }

 private:
  /// One cache line.
  struct alignas(64) Known {
    Vec2 position_m;
    Vec2 velocity_mps;
    SteadyTime as_of;
    RobotId robot;
    std::uint32_t sequence = 0;
    double radius_m = 0.0;
    float late_s = 0.0F;
    bool gone = false;  // left the neighbourhood
  };
  /// Index into known_. Small, so that three of four slots can be free and still few lines are
  /// used.
  using Slot = std::uint16_t;
  static constexpr Slot kFree = 0xFFFF;

  Slot& slot_of(RobotId robot);
  void insert(RobotId robot, Slot& slot);
  void judge_link(const Known& before, const NeighbourReport& report, const Vec2& own_position_m);
  void rebuild_index();
  void sift(SteadyTime now, const Vec2& own_position_m);
  void believe(Known& r, SteadyTime now, const Vec2& own_position_m);

  NeighbourOptions options_;
  double period_s_;
  double silence_s_;  // that is expected
  double forget_after_s_;
  std::vector<Known> known_;
  std::vector<std::uint32_t> candidates_;  // indices into known_, the first candidates_found_
  std::size_t candidates_found_ = 0;
  std::vector<Slot> index_;  // hash table with open addressing, a power of two of them
  std::vector<Neighbour> neighbours_;
  std::size_t gone_ = 0;  // of known_, as of the last at()
  LinkQuality link_;
  double loss_ = 0.0;  // share of words lost, mean of the last ones
};

}  // namespace swarm::agent
