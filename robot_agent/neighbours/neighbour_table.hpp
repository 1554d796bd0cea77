// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "robot_agent/neighbours/silent_robots.hpp"
#include "swarm_core/base/lanes.hpp"
#include "swarm_core/base/prefetch.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarm_core/mission/fleet.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/robot/neighbour.hpp"

namespace swarm::agent {

/// A state that another robot published of itself, after input validation.
struct NeighbourReport {
  RobotId robot;
  std::uint32_t sequence = 0;
  SteadyTime as_of;  ///< when the state was measured, on our steady clock
  Vec2 position_m = Vec2::Zero();
  Vec2 velocity_mps = Vec2::Zero();
};

/// The neighbours within reach; valid until the next call of at() by the same thread.
struct Neighbourhood {
  std::span<const Neighbour> all;
  std::span<const Neighbour> close;  ///< the first of `all`: may touch us or bound our speed
  bool is_within_silent = false;     ///< of a silent robot's disc: stand (see SilentRobots)
};

/// How well messages of other robots reach this one; its own are assumed to reach them as well.
struct LinkQuality {
  bool poor = false;    ///< degraded: messages are lost, or later than 1.5 control periods
  double late_s = 0.0;  ///< mean age of messages on receipt
};

/// What the table of one robot is made with.
struct NeighbourOptions {
  double radius_m = 0.2;                ///< of the robot itself
  Fleet fleet;                          ///< sizes and speeds of the others
  double communication_radius_m = 6.0;  ///< robots received or extrapolated farther off are dropped
  /// at() leaves out robots farther than this: they matter neither to control nor to safety. For
  /// information older than a control period it grows by reach_growth_mps, plus the distance by
  /// which extrapolation may overshoot if the robot has stopped.
  double reach_m = 6.0;
  double close_m = 6.0;  ///< robots nearer than this, which grows alike, are close
  double reach_growth_mps = 0.0;
  double near_m = 1.0;          ///< on a degraded link robots this near publish at every tick
  Duration period{};            ///< of control: a body stops two periods after its last command
  Duration expected_silence{};  ///< a healthy robot publishes at least this often
  Duration forget_after{};      ///< a silent robot is extrapolated until then
  double scale = 1.0;  ///< of the speed below which a robot counts as stopped (body_scale.hpp)
};

/// The robots near us, as known from their published states. Between two state updates the position
/// of a robot is extrapolated, and `possible_stop_age_s` bounds for how long it may have been
/// stopped meanwhile. From `expected_silence` on the SilentRobots of the process keep its possible
/// positions, if it is near. A table without them lets its radius grow by its largest speed for
/// every second more, and forgets it after `forget_after`: that is for simulations, in which dead
/// robots are obstacles at once. In a dense region a robot receives fifty others at every tick:
/// take() is one look-up in a hash table, at() one SIMD pass over an array, four robots at a time.
/// The same reports in the same order give the same neighbours in the same order. No allocation
/// once warm.
class NeighbourTable {
 public:
  explicit NeighbourTable(Shared<NeighbourOptions> options);

  /// What became of a report.
  enum class Outcome { kTaken, kDuplicate, kStale, kFar };

  /// Takes a report that was `late` when it was received. Older or repeated sequence numbers are
  /// refused; a robot that was silent for `forget_after` may start over (it was restarted).
  Outcome take(const NeighbourReport& report, const Vec2& own_position_m, Duration late = {});

  /// Neighbours within reach as of `now`; the silent ones from `silent`, if it is not null.
  Neighbourhood at(SteadyTime now, const Vec2& own_position_m,
                   const SilentRobots* silent = nullptr);

  /// Brings what take() and at() read into the cache. A loop that ticks many robots in turn calls
  /// it while it ticks the robot before.
  void prefetch() const {
    swarm::prefetch(blocks_.data(), blocks_.size() * sizeof(LaneBlock));
    swarm::prefetch(index_.data(), index_.size() * sizeof(Slot));
  }

  const LinkQuality& link() const { return link_; }

  /// Robots known at the last at(), within reach or not.
  std::size_t known() const { return count_ - gone_; }

 private:
  /// The last state updates of four robots, in two cache lines, relative to then_ and here_m_ so
  /// that floats resolve them to micrometres.
  struct alignas(64) LaneBlock {
    Float4 x_m, y_m;
    Float4 vx_mps, vy_mps;
    Int4 as_of_us;  // kGone: no robot in this lane
    Int4 late_us;
    std::array<RobotId, kLanes> robot;
    std::array<std::uint32_t, kLanes> sequence;
  };
  static constexpr std::int32_t kGone = -(1 << 30);
  /// Number of a robot in blocks_. Small, so that three of four slots can be free and still few
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
  bool is_silent(std::size_t known, const FilterPass& pass, const SilentRobots& silent) const;
  void sweep();

  Shared<NeighbourOptions> options_;
  double period_s_;
  double silence_s_;  // expected_silence
  std::int32_t period_us_;
  std::int32_t silence_us_;
  std::int32_t forget_after_us_;
  // Origin of the times and positions in blocks_, see keep_frame().
  SteadyTime then_;
  Vec2 here_m_ = Vec2::Zero();
  std::vector<LaneBlock> blocks_;
  std::size_t count_ = 0;    // of robots in blocks_, gone or not
  std::size_t gone_ = 0;     // of those, as of the last at()
  std::vector<Slot> index_;  // hash table with open addressing, a power of two of them
  /// The messages since the last at().
  struct Tally {
    std::uint32_t updates = 0;
    /// Messages that count as received when the loss rate is computed: those without skipped
    /// numbers before them, and those whose sender was in range at both ends of the skipped ones.
    std::uint32_t came = 0;
    std::uint32_t lost = 0;    // skipped numbers that count as lost
    std::int64_t late_us = 0;  // sum of the ages on receipt
  };
  Tally tally_;
  LinkQuality link_;
  double loss_ = 0.0;  // moving average of the share of messages lost
};

}  // namespace swarm::agent
