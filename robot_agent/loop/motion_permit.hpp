// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "swarmflow/core/time.hpp"

namespace swarm::agent {

/// Why the robots of a process stand at zero velocity, without avoidance.
enum class StandReason : std::uint8_t {
  kNone,          ///< they may move
  kCellsMissing,  ///< the states of a cell that they need cannot be received
  kFilesMissing,  ///< the same, since the process can open no more files
  kWaking,        ///< the process slept longer than a command lasts: it receives before it moves
  kCutOff,        ///< planner and launcher are not received, or not for long enough yet
  kIsObstacle,    ///< not received by the launcher, which has made the body an obstacle
};

/// As an event has it.
constexpr std::string_view to_string(StandReason reason) {
  switch (reason) {
    case StandReason::kNone:
      return "moves again";
    case StandReason::kCellsMissing:
      return "cannot receive the states of all cells around: stands";
    case StandReason::kFilesMissing:
      return "cannot receive the states of all cells around, as it can open no more files "
             "(ulimit -n): stands";
    case StandReason::kWaking:
      return "slept longer than a command lasts: stands until it has received its neighbours";
    case StandReason::kCutOff:
      return "receives neither planner nor launcher: stands";
    case StandReason::kIsObstacle:
      return "is an obstacle of the scene: stands until the launcher receives it";
  }
  return "";
}

/// Decides whether the robots of a process may move: only where they would receive who is there.
/// A robot that is cut off stands at the latest `cut_off_after` + 2 Δt + its lag after the last
/// message of planner or launcher, so that others can bound where it may be (see SilentRobots). One
/// that receives, but is not received, learns so from the scene, and stands where others have it.
/// Pure; the time is passed in.
class MotionPermit {
 public:
  /// The times of a mission.
  struct Options {
    Duration period{};         ///< Δt, of control: a command lasts two of them
    Duration full_interval{};  ///< within it every healthy neighbour publishes
    Duration cut_off_after{};  ///< without planner and launcher
    /// By then the launcher has reported who fell silent while this process was cut off.
    Duration rejoin_interval{};
    /// The process begins while the others move: it joins them as one that was cut off.
    bool in_flight = false;
  };

  explicit MotionPermit(const Options& options)
      : options_(options), has_moved_(options.in_flight) {}

  /// What the process receives at a tick.
  struct Reception {
    SteadyTime now;
    std::optional<SteadyTime> planner{};   ///< of the last heartbeat
    std::optional<SteadyTime> launcher{};  ///< of the last beat
    bool all_cells = true;
    bool is_obstacle = false;  ///< a body of the process, in the scene
    bool lacks_files = false;  ///< that is why it does not receive all cells
  };

  /// Call it at each tick. The first reason that applies, in the order of the enumeration.
  StandReason update(const Reception& reception) {
    const SteadyTime now = reception.now;
    const Duration slept = now - last_tick_.value_or(now);
    if (slept > 2 * options_.period) woke_at_ = now;
    last_tick_ = now;
    constexpr SteadyTime kNever = SteadyTime::min();
    const SteadyTime newest =
        std::max(reception.planner.value_or(kNever), reception.launcher.value_or(kNever));
    // What a process missed that slept for longer is not known: it may have been cut off as well.
    const bool was_cut_off = is_cut_off_ || slept > options_.cut_off_after;
    is_cut_off_ = newest == kNever || now - newest > options_.cut_off_after;
    if (was_cut_off && !is_cut_off_ && has_moved_) back_at_ = now;
    if (!reception.all_cells) {
      return reception.lacks_files ? StandReason::kFilesMissing : StandReason::kCellsMissing;
    }
    if (is_within(options_.full_interval, woke_at_, now)) return StandReason::kWaking;
    // What a process reads when it wakes may have waited in its sockets all the time it slept: it
    // is no sign that anything is received now.
    const bool is_stale = newest <= woke_at_.value_or(kNever);
    if (is_cut_off_ || is_stale || is_within(options_.rejoin_interval, back_at_, now))
      return StandReason::kCutOff;
    if (reception.is_obstacle) return StandReason::kIsObstacle;
    has_moved_ = true;
    return StandReason::kNone;
  }

 private:
  static bool is_within(Duration span, std::optional<SteadyTime> begin, SteadyTime now) {
    return begin && now - *begin < span;
  }

  Options options_;
  bool is_cut_off_ = true;
  bool has_moved_ = false;
  std::optional<SteadyTime> back_at_;  // received again after a time without
  std::optional<SteadyTime> last_tick_;
  std::optional<SteadyTime> woke_at_;
};

}  // namespace swarm::agent
