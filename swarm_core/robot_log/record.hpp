// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "swarm_core/metrics/histogram.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"

/// The robot log: each robot appends to its own file, at control rate. Audits and reports are
/// computed from these files alone.
namespace swarm::robot_log {

/// Start of an incarnation of this robot's process (a respawned robot has several in one file).
struct Header {
  RobotId robot;
  std::uint32_t robots = 0;      ///< number of robots of the swarm
  std::uint32_t process_id = 0;  ///< of the operating system
  double radius_m = 0.0;         ///< of the robot's body
  UtcTime stamp{};               ///< when the process started
};

/// One control step: where the robot was at `stamp` and what it commanded from then on.
struct Step {
  UtcTime stamp{};
  Vec2 position_m = Vec2::Zero();
  Vec2 velocity_mps = Vec2::Zero();  ///< commanded
  std::int32_t lateness_us = 0;      ///< actual minus scheduled start of the tick
  std::uint8_t mode = 0;             ///< link::RobotMode
  std::uint8_t goal = kNoGoal;       ///< sink of the plan this robot goes to
  std::uint16_t neighbours = 0;      ///< robots it estimated to be near
  std::uint32_t plan_version = 0;    ///< of the plan followed in time; 0: it follows none in time
  float plan_time_s = 0.0F;          ///< τ, that plan's clock, as the robot has it
  float reference_x_m = 0.0F;        ///< x_ref(τ): where the plan has this robot at τ
  float reference_y_m = 0.0F;
  static constexpr std::uint8_t kNoGoal = 255;
};

/// How long a driver executes the command of a step. `period`: of control.
constexpr Duration command_lifetime(Duration period) { return 2 * period; }

/// Records are handed to the disk several at a time, which costs less; a process with many robots
/// takes more, and lets them wait for up to a second. A process that is killed loses those that it
/// has not handed over.
constexpr std::uint32_t kRecordsAtOnce = 4;
constexpr std::uint32_t kManyRobots = 20;
constexpr std::uint32_t kRecordsOfManyAtOnce = 10;

/// The largest time between the last step of a robot whose process was killed and the end of its
/// log, with a disk that keeps up. `robots`: of its process; `period`: of control.
constexpr Duration log_delay(std::uint32_t robots, Duration period) {
  const Duration step = 3 * period;
  return robots < kManyRobots ? step + kRecordsAtOnce * period
                              : step + kRecordsOfManyAtOnce * period + std::chrono::seconds(1);
}

/// Where the body of a robot comes to rest whose process died after this step: its driver executes
/// the last command until that runs out.
inline Vec2 rest_position_m(const Step& last, Duration period) {
  return last.position_m + to_seconds(command_lifetime(period)) * last.velocity_mps;
}

/// The robot's estimate of a neighbour's position at `stamp`; the neighbours near it are recorded
/// in turn.
struct Estimate {
  UtcTime stamp{};
  RobotId neighbour;
  Vec2 position_m = Vec2::Zero();
};

/// Counters since the process started, recorded once a second and at the end.
struct LinkStats {
  UtcTime stamp{};
  std::uint32_t states_sent = 0;
  std::uint32_t states_received = 0;
  std::vector<std::uint32_t> refused{};  ///< by link::RefusalReason
  Histogram state_age{};                 ///< written → used by the controller
};

/// Something that happened to this robot.
struct Note {
  UtcTime stamp{};
  UtcTime caused{};    ///< stamp of the message that caused it; 0 if none
  std::string code{};  ///< as link::EventMessage::code
  std::string text{};
};

/// Any record; the order of the alternatives is the order of the log's channels.
using Record = std::variant<Header, Step, Estimate, LinkStats, Note>;

}  // namespace swarm::robot_log
