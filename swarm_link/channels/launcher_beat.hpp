// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/ids.hpp"

namespace swarm::link {

/// Robots with consecutive ids: first to first + count − 1.
struct RobotRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  bool operator==(const RobotRange&) const = default;
};

/// A robot whose next status is late, and where it was at the last one.
struct LateRobot {
  std::uint32_t robot = 0;   ///< id
  std::uint32_t age_ms = 0;  ///< of the position when the beat was sent
  double x_m = 0.0;          ///< position, world frame [m]
  double y_m = 0.0;
  bool operator==(const LateRobot&) const = default;
};

/// The launcher's sign of life, twice a second, with the robots that it does not receive. It states
/// nothing about the others while `lists_all` is false: then there were more silent robots than a
/// beat has room for, or a gateway does not run, or the launcher was suspended. A plain value
/// without heap memory, so that receiving one allocates nothing.
struct LauncherBeat {
  static constexpr std::size_t kMaxRanges = 1000;  ///< enough for 2000 robots, however they lie
  static constexpr std::size_t kMaxLate = 24;

  std::uint64_t run = 0;       ///< of the run that it belongs to: the time of its begin [ns]
  std::uint64_t sequence = 0;  ///< from 1; a lower or equal one is out of date
  std::int64_t sent_ns = 0;    ///< when it was sent, by the run's clock [ns]
  bool lists_all = true;
  bool lists_all_late = true;  ///< whether `late()` are all whose status is late
  std::uint32_t ranges = 0;    ///< number of those in use
  std::array<RobotRange, kMaxRanges> range{};
  std::uint32_t late_robots = 0;  ///< number of those in use
  std::array<LateRobot, kMaxLate> late_robot{};

  std::span<const RobotRange> silent() const { return std::span(range).first(ranges); }
  std::span<const LateRobot> late() const { return std::span(late_robot).first(late_robots); }
};

/// Fills in the silent robots, whose ids ascend.
void set_silent(LauncherBeat& beat, std::span<const RobotId> robots);

/// Fills in the late robots; of more than kMaxLate the first, and then not all are listed.
void set_late(LauncherBeat& beat, std::span<const LateRobot> robots);

/// The bytes of a beat, without the datagram's header: run, sequence, sent_ns, flags (1: lists_all,
/// 2: lists_all_late) and the number of ranges, as little-endian integers of 8, 8, 8, 4 and 4
/// bytes; then the members of the ranges and of the late robots as they are declared.
void encode(const LauncherBeat& beat, std::vector<std::byte>& out);

/// False if the bytes are no beat: then `beat` is unchanged. The ids are not checked.
bool decode(std::span<const std::byte> bytes, LauncherBeat& beat);

}  // namespace swarm::link
