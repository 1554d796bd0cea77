// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "robot_agent/loop/pose_check.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/robot/driver.hpp"

namespace swarm::agent {

/// What a check of a driver needs to know of the robot and of the place where it stands.
struct DriverCheckOptions {
  Duration period = std::chrono::milliseconds(100);  ///< of control
  double speed_mps = 0.3;                            ///< at which it is driven about
  /// Half of the side of the square that it may use, about where it stands. It drives half of it;
  /// at the edge the check stops it, and ends.
  double room_m = 2.0;
  double lag_s = 0.0;    ///< until the body has a commanded velocity
  double noise_m = 0.0;  ///< σ of the measured position, of one step's motion included
  PoseLimits pose = PoseLimits::of(BodySpec{});
  Duration connects_within = std::chrono::seconds(10);  ///< to the first position
  Duration lifts_within = std::chrono::seconds(30);     ///< to take off, and to land
  bool may_kill = false;                                ///< cut the motors at the end
  /// Takes the robot's localisation away and gives it back, and returns whether that worked; empty:
  /// that clause is not tried.
  std::function<bool(bool is_cut)> cut_pose{};
  /// Whether to stop the robot and end; empty: never.
  std::function<bool()> must_end{};

  /// For one robot of a mission.
  static DriverCheckOptions of(const Mission& mission, RobotId robot);
};

/// The time that passes in a check; a test replaces it.
class CheckClock {
 public:
  virtual ~CheckClock() = default;
  virtual SteadyTime now() = 0;
  virtual void sleep_until(SteadyTime time) = 0;
};

/// What a check found out about one clause of the contract in driver.hpp.
struct ClauseResult {
  enum class Verdict : std::uint8_t { kKept, kBroken, kNotTried };
  std::string_view clause;  ///< name: position, frames, watchdog, ...
  Verdict verdict = Verdict::kKept;
  std::string text{};  ///< what was measured
};

/// Makes a driver of the robot, as its registry does; called twice.
using MakeDriver = std::function<Result<std::unique_ptr<Driver>>()>;

/// Drives one robot about, alone, and reports each clause of the contract: that it starts, and
/// again after a shutdown; has a position; moves where it is commanded to, in the world frame;
/// stops when its command runs out, also if no call comes any more; stops when commanded to, and
/// goes on after it; reports that it has lost its position; does not block. Takes about a minute
/// and a half of the clock. Clauses that cannot be tried after a failure before are not tried. The
/// robot is commanded to stop before its driver is shut down, and landed if it flies.
std::vector<ClauseResult> check_driver(const MakeDriver& make, const DriverCheckOptions& options,
                                       CheckClock& clock);

}  // namespace swarm::agent
