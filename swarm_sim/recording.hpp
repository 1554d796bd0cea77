// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "robot_agent/loop/robot_log.hpp"
#include "swarm_core/robot_log/record.hpp"
#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::launcher {

/// The robot logs of a simulation, in memory, period by period: robots write to it one after the
/// other, so recording writes memory in order and evicts little from the cache. Several threads may
/// record, each robot by one at a time. Robots whose processes are dead have no steps.
class Recording {
 public:
  /// Keeps every n-th period, from the first one on, and the last. \pre keeps_every ≥ 1
  Recording(const Mission& mission, UtcTime begin, std::uint64_t keeps_every);
  static constexpr std::uint64_t kFirstAndLast = std::numeric_limits<std::uint64_t>::max();

  /// Begins a control period, in which every robot records at most one step.
  void begin_period() {
    const bool last_is_kept = begun_ == 0 || (begun_ - 1) % keeps_every_ == 0;
    if (last_is_kept) periods_.emplace_back(notes_.size(), robot_log::Step{.stamp = kNever});
    ++begun_;
  }
  void step(RobotId robot, const robot_log::Step& step) { periods_.back()[robot.value()] = step; }
  /// A robot's estimate of a neighbour; kept in every n-th period, from the first one on.
  void estimate(RobotId robot, const robot_log::Estimate& estimate) {
    if ((begun_ - 1) % keeps_every_ == 0) estimates_[robot.value()].push_back(estimate);
  }
  /// Records a note; its order relative to the step of the same stamp is kept.
  void note(RobotId robot, robot_log::Note note);
  /// The last two steps of a robot that are kept, the newest last.
  std::vector<robot_log::Step> last_steps(RobotId robot) const;

  /// Counters of the network, of all robots together.
  struct Link {
    std::uint64_t states_sent = 0;
    std::uint64_t states_received = 0;
    std::vector<std::uint32_t> refused{};  ///< by link::RefusalReason; empty: none
    Histogram state_age{};
  };
  Link& link() { return link_; }

  /// As a monitor would have read it.
  std::vector<monitor::Track> tracks() const;
  /// Writes `robot_log/robot-….mcap` into a run directory.
  Result<void> write(const std::filesystem::path& run_dir) const;

 private:
  static constexpr UtcTime kNever = UtcTime::min();  // stamp of a robot without a step in a period

  template <class Take>
  /// Passes all records of a robot to `take`, in the order of a log file.
  void replay(std::uint32_t robot, Take take) const;

  const Mission& mission_;
  UtcTime begin_;
  // Periods per period kept, and periods begun so far.
  std::uint64_t keeps_every_;
  std::uint64_t begun_ = 0;
  std::vector<std::vector<robot_log::Step>> periods_;  // per period, a step of each robot
  /// A note, and whether it comes after the step of the same moment.
  struct PlacedNote {
    robot_log::Note note;
    bool follows_step;
  };
  std::vector<std::vector<PlacedNote>> notes_;               // of each robot
  std::vector<std::vector<robot_log::Estimate>> estimates_;  // of each robot
  Link link_;
};

/// The log of one robot, as its control loop writes it.
class RobotRecording final : public agent::RobotLog {
 public:
  RobotRecording(Recording& recording, RobotId robot) : recording_(recording), robot_(robot) {}
  void append(const robot_log::Step& step) override { recording_.step(robot_, step); }
  void append(const robot_log::Estimate& estimate) override {
    recording_.estimate(robot_, estimate);
  }
  void append(robot_log::Note note) override { recording_.note(robot_, std::move(note)); }

 private:
  Recording& recording_;
  RobotId robot_;
};

}  // namespace swarm::launcher
