// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "swarm_core/robot_log/record.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::monitor {

/// A run directory written by hand, in a temporary folder that goes with it: a field of 40 x 20 m
/// with a circle of radius 2 m in its middle, one goal left (30, 5), one right (30, 15), robots of
/// 0.2 m.
class SyntheticRun {
 public:
  explicit SyntheticRun(std::uint32_t robots);
  ~SyntheticRun();
  SyntheticRun(const SyntheticRun&) = delete;
  SyntheticRun& operator=(const SyntheticRun&) = delete;

  const std::filesystem::path& dir() const { return dir_; }

  /// Where and when robots are, and what they do. Step k is taken at k·0.1 s.
  struct Incarnation {
    std::vector<Vec2> positions_m;
    std::uint8_t goal = 0;
    double begin_s = 0.0;
    bool graceful = true;
    std::uint32_t process_id = 1000;
    std::int32_t lateness_us = 100;
    std::vector<std::uint32_t> refused{};
    std::vector<std::int64_t> ages_us{};
    std::uint32_t states_sent = 0;
    std::size_t moves_from = 0;                             ///< waits before this step
    std::size_t arrives_at = static_cast<std::size_t>(-1);  ///< step; default: the last
  };

  /// Appends a life to a robot's robot log.
  void write(std::uint32_t robot, const Incarnation& incarnation) const;

  /// Writes robots that all drive to their goals without fault: even ids to goal 0, odd to goal 1.
  void write_good_run() const;

  void write_file(const std::string& name, const std::string& content) const;

 private:
  std::uint32_t robots_;
  std::filesystem::path dir_;
};

/// n+1 points from a to b.
std::vector<Vec2> straight(const Vec2& a, const Vec2& b, int n);

/// A step's time.
UtcTime at_s(double time_s);

}  // namespace swarm::monitor
