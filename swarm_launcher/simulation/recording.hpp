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

/// The black boxes of a simulation, in memory. Robots may be recorded by several threads, each
/// robot by one at a time.
class Recording {
 public:
  /// Nothing is kept if `steps` is false but where robots began and ended.
  Recording(const Mission& mission, UtcTime begin, bool steps);

  void step(RobotId robot, const blackbox::Step& step) {
    std::vector<blackbox::Step>& kept = robots_[robot.value()].steps;
    if (keeps_steps_ || kept.size() < 2) {
      kept.push_back(step);
    } else {
      kept.back() = step;
    }
  }
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
  struct Robot {
    std::vector<blackbox::Step> steps;
    std::vector<blackbox::Note> notes;
  };
  template <class Take>
  void replay(std::uint32_t robot, Take take) const;

  const Mission& mission_;
  UtcTime begin_;
  bool keeps_steps_;
  std::vector<Robot> robots_;
  Link link_;
};

}  // namespace swarm::launcher
