// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "swarm_core/blackbox/record.hpp"
#include "swarm_core/mission/mission.hpp"
#include "swarm_monitor/recorded_run.hpp"

namespace swarm::launcher {

/// The black boxes of a simulation, in memory, a control period after the other: a swarm writes
/// them as it goes from robot to robot, so in flight they cost the cache nothing. Robots may be
/// recorded by several threads, each robot by one at a time.
class Recording {
 public:
  /// Nothing is kept if `steps` is false but where robots began and ended.
  Recording(const Mission& mission, UtcTime begin, bool steps);

  /// Every robot makes one step in it.
  void begin_period() {
    if (keeps_steps_ || periods_.size() < 2) periods_.emplace_back(notes_.size());
  }
  void step(RobotId robot, const blackbox::Step& step) { periods_.back()[robot.value()] = step; }
  void note(RobotId robot, UtcTime at, std::string code, std::string text);

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
  template <class Take>
  void replay(std::uint32_t robot, Take take) const;

  const Mission& mission_;
  UtcTime begin_;
  bool keeps_steps_;
  std::vector<std::vector<blackbox::Step>> periods_;  // each of all robots
  std::vector<std::vector<blackbox::Note>> notes_;    // of each robot
  Link link_;
};

}  // namespace swarm::launcher
