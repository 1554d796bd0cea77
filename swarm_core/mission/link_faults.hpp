// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm {

/// Faults injected into the network, for each message and receiver independently.
struct LinkFaults {
  double loss = 0.0;       ///< share that never arrives
  Duration delay{};        ///< mean transit time added to each message
  Duration jitter{};       ///< each message comes up to this much earlier or later than `delay`
  double duplicate = 0.0;  ///< share that arrives twice, the second time with a delay of its own
  Duration from{};         ///< the faults begin at this time since the run began
  Duration until = Duration::max();  ///< the faults end at this time since the run began
  /// Receivers: the robots first to last; the planner, unless robots are chosen; the launcher, if
  /// that is wanted. Others receive everything, so that a cut is one-way.
  std::uint32_t first_robot = 0;
  std::uint32_t last_robot = kAllRobots;
  bool at_launcher = false;
  static constexpr std::uint32_t kAllRobots = 0xFFFF'FFFF;

  /// Whether any message can be lost or delayed.
  bool any() const {
    return loss > 0.0 || delay > Duration::zero() || jitter > Duration::zero() || duplicate > 0.0;
  }
  /// Whether a process with the robots first to first + count − 1 is hit.
  bool at_robots(std::uint64_t first, std::uint64_t count) const {
    return first <= last_robot && first + count > first_robot;
  }
  bool at_planner() const { return first_robot == 0 && last_robot == kAllRobots; }
  /// Whether the faults are in force at a time since the run began.
  bool at(Duration since_begin) const { return since_begin >= from && since_begin < until; }
};

/// Reads `loss=0.2,delay-ms=150,jitter-ms=50,duplicate=0.1,from=10,to=60,robots=3-5,launcher=1`:
/// every key may be left out, times since the run began are in seconds. kBadInput names what is
/// allowed.
Result<LinkFaults> parse_link_faults(std::string_view text);

/// The delay with which a message arrives, or nothing if it is lost. A function of the faults, the
/// seed and the number of the message alone, so a run can be repeated.
std::optional<Duration> fate(const LinkFaults& faults, std::uint64_t seed, std::uint64_t message);

/// The delay of a second copy of the message, or nothing if there is none.
std::optional<Duration> fate_of_copy(const LinkFaults& faults, std::uint64_t seed,
                                     std::uint64_t message);

}  // namespace swarm
