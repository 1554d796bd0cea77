// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "swarm_core/blackbox/record.hpp"
#include "swarm_core/mission/mission.hpp"
#include "swarm_monitor/recorded_run.hpp"

namespace swarm::launcher {

/// The black boxes of a simulation, in memory, a control period after the other: a swarm writes
/// them as it goes from robot to robot, so in flight they cost the cache nothing. Robots may be
/// recorded by several threads, each robot by one at a time. The dead make no steps.
class Recording {
 public:
  /// Keeps every so manieth period, from the first one on, and the last. \pre keeps_every ≥ 1
  Recording(const Mission& mission, UtcTime begin, std::uint64_t keeps_every);
  static constexpr std::uint64_t kFirstAndLast = std::numeric_limits<std::uint64_t>::max();

  /// Every robot makes at most one step in it.
  void begin_period() {
    const bool last_is_kept = begun_ == 0 || (begun_ - 1) % keeps_every_ == 0;
    if (last_is_kept) periods_.emplace_back(notes_.size(), blackbox::Step{.stamp = kNever});
    ++begun_;
  }
  void step(RobotId robot, const blackbox::Step& step) { periods_.back()[robot.value()] = step; }
  void note(RobotId robot, UtcTime at, std::string code, std::string text);
  /// The last two steps of a robot that are kept, the newest last.
  std::vector<blackbox::Step> last_steps(RobotId robot) const;

  /// What the network did, told once for all robots together.
  struct Link {
    std::uint64_t states_sent = 0;
    std::uint64_t states_received = 0;
    Histogram state_age{};
  };
  Link& link() { return link_; }

  /// As a monitor would have read it.
  std::vector<monitor::Track> tracks() const;
  /// Writes `blackbox/robot-….mcap` into a run directory.
  Result<void> write(const std::filesystem::path& run_dir) const;

 private:
  static constexpr UtcTime kNever = UtcTime::min();  // a step that was not made

  template <class Take>
  void replay(std::uint32_t robot, Take take) const;

  const Mission& mission_;
  UtcTime begin_;
  std::uint64_t keeps_every_;
  std::uint64_t begun_ = 0;
  std::vector<std::vector<blackbox::Step>> periods_;  // each of all robots
  std::vector<std::vector<blackbox::Note>> notes_;    // of each robot
  Link link_;
};

}  // namespace swarm::launcher
